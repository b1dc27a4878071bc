"""The point-line network: a shared backbone, heads for key points and descriptors, a branch for lines.

All maps are N x C x H x W. An image's height and width are multiples of 16. Pixel (0, 0)'s centre is the origin; cell (i, j) of a
map of stride s has its centre at x = s j + (s - 1) / 2, y = s i + (s - 1) / 2.
"""
import math

import torch
import torch.nn.functional as F
from torch import nn

DESCRIPTOR_SIZE = 64
ATTRACTION_PX = 10.0  # a pixel farther than this from every segment's interior belongs to none
END_SCALE_PX = 16.0  # an end point t pixels along the line from the foot is stated as the angle atan(t / END_SCALE_PX)

POINT_MODULES = ("stem", "stage4", "stage8", "stage16", "up8", "up4", "points", "dustbin", "descriptors")


class LocalContrast(nn.Module):
    """(image - mean) / deviation over some 40 pixels around: what a gain control did to the greys cancels to first order.

    `floor` keeps noise on a blank wall from being blown up; about 3 grey levels of 255.
    """

    def __init__(self, floor=0.012):
        super().__init__()
        self.floor = floor

    def forward(self, image):
        cells = F.avg_pool2d(image, 8)
        squares = F.avg_pool2d(image * image, 8)
        around = torch.cat([cells, squares], 1)
        around = F.avg_pool2d(around, 5, stride=1, padding=2, count_include_pad=False)
        around = F.interpolate(around, scale_factor=8, mode="bilinear", align_corners=False)
        mean, square = around[:, :1], around[:, 1:]
        deviation = torch.sqrt(torch.clamp(square - mean * mean, min=0.0) + self.floor**2)
        return torch.clamp((image - mean) / deviation, -4.0, 4.0)


class Conv(nn.Sequential):
    def __init__(self, inputs, outputs, size=3, stride=1, groups=1):
        super().__init__(
            nn.Conv2d(inputs, outputs, size, stride, size // 2, groups=groups, bias=False), nn.BatchNorm2d(outputs), nn.ReLU())


def linear(inputs, outputs, size=1, groups=1):
    """A convolution and its normalisation, which folds into it for inference."""
    return nn.Sequential(nn.Conv2d(inputs, outputs, size, 1, size // 2, groups=groups, bias=False), nn.BatchNorm2d(outputs))


class Residual(nn.Module):
    def __init__(self, width):
        super().__init__()
        self.body = linear(width, width, 3)

    def forward(self, x):
        return F.relu(x + self.body(x))


class Separable(nn.Module):
    """A convolution a channel, then one across channels, beside the identity."""

    def __init__(self, width, size=3):
        super().__init__()
        self.body = nn.Sequential(linear(width, width, size, width), linear(width, width))

    def forward(self, x):
        return F.relu(x + self.body(x))


class UpAdd(nn.Module):
    """Brings a fine and a coarse map of twice the stride to one width and adds them."""

    def __init__(self, fine, coarse, width):
        super().__init__()
        self.fine = linear(fine, width)
        self.coarse = linear(coarse, width)

    def forward(self, fine, coarse):
        return F.relu(self.fine(fine) + F.interpolate(self.coarse(coarse), scale_factor=2, mode="bilinear", align_corners=False))


class PlNet(nn.Module):
    def __init__(self):
        super().__init__()
        self.contrast = LocalContrast()
        self.stem = Conv(1, 16, 5, 2)
        self.stage4 = nn.Sequential(Conv(16, 32, 3, 2), Residual(32))
        self.stage8 = nn.Sequential(Conv(32, 64, 3, 2), Residual(64))
        self.stage16 = nn.Sequential(Conv(64, 64, 3, 2), Residual(64))
        self.up8 = UpAdd(64, 64, 64)
        self.up4 = UpAdd(32, 64, 48)
        self.points = nn.Sequential(Separable(48), nn.Conv2d(48, 16, 1))
        self.dustbin = nn.Sequential(Separable(64), nn.Conv2d(64, 1, 1))
        self.descriptors = nn.Sequential(Separable(64), Conv(64, 96, 1), nn.Conv2d(96, DESCRIPTOR_SIZE, 1))
        self.line8 = nn.Sequential(Conv(64, 48, 1), Separable(48, 5))
        self.line16 = nn.Sequential(Conv(48, 48, 3, 2, groups=4), Separable(48, 5), Separable(48, 5))
        self.line_up = UpAdd(48, 48, 48)
        self.line4 = UpAdd(32, 48, 48)
        self.lines = nn.Sequential(Separable(48), Separable(48), nn.Conv2d(48, 9, 1))

    def forward(self, image):
        """image: N x 1 x H x W, 0 to 1. Returns raw maps: points (65 channels, stride 8), descriptors (stride 8), lines (9, stride 4)."""
        c4 = self.stage4(self.stem(self.contrast(image)))
        c8 = self.stage8(c4)
        f8 = self.up8(c8, self.stage16(c8))
        fine = self.points(self.up4(c4, f8))
        points = torch.cat([F.pixel_unshuffle(fine, 2), self.dustbin(f8)], 1)
        line8 = self.line8(f8)
        lines = self.lines(self.line4(c4, self.line_up(line8, self.line16(line8))))
        return points, self.descriptors(f8), lines


def point_channel(x, y):
    """Channel of PlNet's point map that stands for the pixel at column x, row y of its cell, both 0 to 7."""
    return ((y % 4) * 4 + x % 4) * 4 + (y // 4) * 2 + x // 4


def score_map(points):
    """Raw point map to the probability that a pixel is a key point, N x 1 x H x W: a soft-max without the transposes that its
    operator costs at run time."""
    odds = torch.exp(torch.clamp(points[:, :64].float() - points[:, 64:].float(), max=30.0))
    return F.pixel_shuffle(F.pixel_shuffle(odds / (1.0 + odds.sum(1, keepdim=True)), 2), 4)


def read_lines(raw):
    """Raw line map to meanings, channels: attraction 0..1; distance px; direction from the pixel to its foot on the line, x and y,
    of any length; two end points as angles 0..pi/2 (end along that direction turned from x towards y, then the other); junction
    0..1; its offset in px from the cell's centre, x and y."""
    attraction, junction = torch.sigmoid(raw[:, 0:1]), torch.sigmoid(raw[:, 6:7])
    distance, ends = ATTRACTION_PX * torch.sigmoid(raw[:, 1:2]), 0.5 * math.pi * torch.sigmoid(raw[:, 4:6])
    return torch.cat([attraction, distance, raw[:, 2:4], ends, junction, 4.0 * torch.sigmoid(raw[:, 7:9]) - 2.0], 1)


class Exported(nn.Module):
    """What the shipped file computes: N x 1 x H x W greys 0..1 to scores (N x 1 x H x W), descriptors of any length and lines."""

    def __init__(self, net):
        super().__init__()
        self.net = net

    def forward(self, image):
        points, descriptors, lines = self.net(image)
        return score_map(points), descriptors, read_lines(lines)
