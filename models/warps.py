"""Random homographies, and images, points and segments under them, many at a time, on whichever device their tensors lie.

A homography (B x 3 x 3) maps pixels of the source to pixels of the crop; pixel (0, 0)'s centre is the origin. Points are B x K x 2,
segments B x M x 4 (x0 y0 x1 y1); where there is none, NaN.
"""
import math

import torch
import torch.nn.functional as F


def uniform(g, shape, low, high):
    return torch.rand(shape, generator=g, device=g.device) * (high - low) + low


def normal(g, shape, sigma=1.0):
    return torch.randn(shape, generator=g, device=g.device) * sigma


def carried(homography, points):
    x, y = points[..., 0], points[..., 1]
    rows = homography[:, :, :, None]
    u, v, w = (rows[:, i, 0] * x + rows[:, i, 1] * y + rows[:, i, 2] for i in range(3))
    return torch.stack([u / w, v / w], -1)


def carried_segments(homography, segments):
    return carried(homography, segments.reshape(len(segments), -1, 2)).reshape(len(segments), -1, 4)


def _shift(x, y):
    matrix = torch.eye(3, device=x.device).repeat(len(x), 1, 1)
    matrix[:, 0, 2], matrix[:, 1, 2] = x, y
    return matrix


def _about(middle, scale, angle, shift, perspective):
    """Turns, scales and slants about (middle, middle), then shifts."""
    turn = torch.eye(3, device=scale.device).repeat(len(scale), 1, 1)
    turn[:, 0, 0] = turn[:, 1, 1] = scale * torch.cos(angle)
    turn[:, 1, 0] = scale * torch.sin(angle)
    turn[:, 0, 1] = -turn[:, 1, 0]
    turn[:, 2, :2] = perspective
    middle = torch.full_like(scale, middle)
    return _shift(middle + shift[:, 0], middle + shift[:, 1]) @ turn @ _shift(-middle, -middle)


def _mostly(g, count, often, seldom):
    """`often` for four in five, `seldom` for the fifth."""
    return torch.where(uniform(g, count, 0, 1) < 0.8, often, seldom)


def random_crop(g, sizes_px, size):
    """From images of sizes_px (B x 2: width, height) to size x size crops: upright within some degrees, shrunk or grown a little,
    every other one mirrored."""
    count = len(sizes_px)
    scale = torch.exp(uniform(g, count, math.log(0.75), math.log(1.5)))
    reach = torch.minimum(0.5 * size / scale[:, None], sizes_px / 2)
    centre = reach + uniform(g, (count, 2), 0, 1) * (sizes_px - 2 * reach)
    angle = _mostly(g, count, normal(g, count, 0.12), uniform(g, count, -math.pi, math.pi))
    to_crop = _shift(size / 2 - centre[:, 0], size / 2 - centre[:, 1])
    mirror = torch.eye(3, device=g.device).repeat(count, 1, 1)
    turned = uniform(g, count, 0, 1) < 0.5
    mirror[:, 0, 0] = torch.where(turned, -1.0, 1.0)
    mirror[:, 0, 2] = torch.where(turned, size - 1.0, 0.0)
    still = torch.zeros(count, 2, device=g.device)
    return mirror @ _about(size / 2, scale, angle, still, normal(g, (count, 2), 0.08 / size)) @ to_crop


def random_motion(g, count, size):
    """What a camera's move does to a crop."""
    scale = torch.exp(normal(g, count, 0.18))
    angle = _mostly(g, count, normal(g, count, 0.2), uniform(g, count, -0.8, 0.8))
    return _about(size / 2, scale, angle, normal(g, (count, 2), 0.1 * size), normal(g, (count, 2), 0.12 / size))


def pixels(height, width, device):
    """Every pixel's place: 1 x (H W) x 2."""
    y, x = torch.meshgrid(torch.arange(height, device=device), torch.arange(width, device=device), indexing="ij")
    return torch.stack([x, y], -1).float().reshape(1, -1, 2)


def sampled(maps, at_px):
    """Maps (B x C x H x W) at places (B x K x 2), bilinear: B x C x K."""
    height, width = maps.shape[2:]
    grid = (at_px + 0.5) / torch.tensor([width, height], device=maps.device) * 2 - 1
    return F.grid_sample(maps, grid[:, :, None], align_corners=False, padding_mode="border")[..., 0]


def warped(images, homography, size, sizes_px=None):
    """Crops (B x 1 x size x size) of images (B x 1 x H x W) and where they show the source (B x size x size, bool)."""
    at = carried(torch.linalg.inv(homography), pixels(size, size, images.device))
    if sizes_px is None:
        sizes_px = torch.tensor([images.shape[3], images.shape[2]], device=images.device).expand(len(images), 2)
    shown = ((at >= -0.5) & (at <= sizes_px[:, None] - 0.5)).all(-1)
    return sampled(images, at).reshape(-1, 1, size, size), shown.reshape(-1, size, size)


def inside(points, width, height, margin=0.0):
    """False for NaN."""
    return ((points >= margin) & (points <= torch.tensor([width - 1.0, height - 1.0], device=points.device) - margin)).all(-1)


def clipped(segments, width, height):
    """Segments cut to an image by Liang and Barsky's method; NaN where they lie outside."""
    start, along = segments[..., :2], segments[..., 2:] - segments[..., :2]
    most = torch.tensor([width - 1.0, height - 1.0], device=segments.device)
    rate, room = torch.cat([-along, along], -1), torch.cat([start, most - start], -1)
    share = room / torch.where(rate == 0, 1e-9, rate)
    first = torch.where(rate < 0, share, 0.0).amax(-1, keepdim=True).clamp(min=0)
    last = torch.where(rate > 0, share, 1.0).amin(-1, keepdim=True).clamp(max=1)
    outside = (last <= first) | ((rate == 0) & (room < 0)).any(-1, keepdim=True)
    cut = torch.cat([start + first * along, start + last * along], -1)
    return torch.where(outside, torch.nan, cut)
