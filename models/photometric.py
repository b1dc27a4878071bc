"""What thermal cameras and their gain controls do to images, at random. Images are B x 1 x H x W, 0..1, on any device."""
import math

import torch
import torch.nn.functional as F

from warps import normal, uniform

LEVELS = 1024


def _some(g, count, share):
    """Which of `count` images something happens to: B x 1 x 1 x 1."""
    return (uniform(g, count, 0, 1) < share)[:, None, None, None]


def _levels(images):
    return (images * (LEVELS - 1) + 0.5).clamp(0, LEVELS - 1).long()


def _curved(images, curves):
    """Curves (B x LEVELS) applied to each image's greys."""
    return torch.gather(curves, 1, _levels(images).flatten(1)).reshape(images.shape)


def random_curves(g, count):
    """Monotone curves of the greys: powers, bent lines of six pieces, or straight (B x LEVELS)."""
    grey = torch.linspace(0, 1, LEVELS, device=g.device)
    power = grey[None] ** torch.exp(uniform(g, (count, 1), -0.8, 0.8))
    rises = -torch.log(uniform(g, (count, 6), 1e-4, 1)) + 0.15
    bent = F.interpolate(F.pad(torch.cumsum(rises, 1), (1, 0))[:, None], LEVELS, mode="linear", align_corners=True)[:, 0]
    bent = bent / rises.sum(1, keepdim=True)
    kind = uniform(g, (count, 1), 0, 1)
    return torch.where(kind < 0.35, power, torch.where(kind < 0.7, bent, grey[None]))


def equalising_curves(images, plateau, most_gain):
    """Histogram equalisation with the count of a grey clipped at `plateau` (a share of all pixels) and a bounded slope (B x LEVELS)."""
    levels = _levels(images).flatten(1)
    counts = torch.zeros(len(images), LEVELS, device=images.device)
    counts.scatter_add_(1, levels, torch.full(levels.shape, 1.0 / levels.shape[1], device=images.device))
    slope = torch.minimum(counts, plateau * 256 / LEVELS)
    slope = torch.minimum(slope / slope.sum(1, keepdim=True).clamp(min=1e-9) * LEVELS, most_gain)
    curves = torch.cumsum(slope, 1) / LEVELS
    return curves + 0.5 * (1.0 - curves[:, -1:])


def gain_controlled(g, images):
    count = len(images)
    images = _curved(images, random_curves(g, count))
    equalised = _curved(images, equalising_curves(images, uniform(g, (count, 1), 0.01, 0.08), uniform(g, (count, 1), 2.0, 8.0)))
    images = torch.where(_some(g, count, 0.35), equalised, images)
    middle = 0.5 * (images.amin((1, 2, 3), keepdim=True) + images.amax((1, 2, 3), keepdim=True))
    gain = torch.exp(uniform(g, (count, 1, 1, 1), math.log(0.3), math.log(1.6)))
    gain = torch.where(_some(g, count, 0.8), gain, 1.0)
    return (images - middle) * gain + (middle + normal(g, middle.shape, 0.12)).clamp(0.2, 0.8)


def _filtered(images, kernels):
    """Each image with a kernel of its own (B x k x k)."""
    reach = kernels.shape[-1] // 2
    padded = F.pad(images, (reach,) * 4, mode="replicate").transpose(0, 1)
    return F.conv2d(padded, kernels[:, None], groups=len(images)).transpose(0, 1)


def blurred(g, images):
    """Blur of the optics, and now and then of a move during the exposure, as one kernel each."""
    count, device = len(images), images.device
    step = torch.arange(-4, 5, device=device, dtype=torch.float32)
    sigma = uniform(g, (count, 1, 1), 0.3, 1.5)
    round_ = torch.exp(-0.5 * (step[None, :, None] ** 2 + step[None, None, :] ** 2) / sigma**2)
    sharp = ((step[None, :, None] == 0) & (step[None, None, :] == 0)).float()
    kernels = torch.where(_some(g, count, 0.6)[:, 0], round_ / round_.sum((1, 2), keepdim=True), sharp)
    reach, angle = uniform(g, (count, 1, 1), 1.0, 3.5), uniform(g, (count, 1, 1), 0, math.pi)
    along = step[None, None, :] * torch.cos(angle) + step[None, :, None] * torch.sin(angle)
    across = step[None, :, None] * torch.cos(angle) - step[None, None, :] * torch.sin(angle)
    trace = (1 - torch.hypot((along.abs() - reach).clamp(min=0), across)).clamp(min=0)
    moved = _filtered(images, trace / trace.sum((1, 2), keepdim=True))
    return _filtered(torch.where(_some(g, count, 0.2), moved, images), kernels)


def noisy(g, images):
    count, _, height, width = images.shape
    columns = normal(g, (count, 1, 1, width)) * uniform(g, (count, 1, 1, 1), 0, 0.012)
    smooth = normal(g, (count, 1, 4, 4)) * uniform(g, (count, 1, 1, 1), 0, 0.06)
    smooth = F.interpolate(smooth, (height, width), mode="bicubic", align_corners=False)
    sigma = torch.where(_some(g, count, 0.8), uniform(g, (count, 1, 1, 1), 0, 0.02), uniform(g, (count, 1, 1, 1), 0.02, 0.05))
    return images + _some(g, count, 0.5) * columns + _some(g, count, 0.3) * smooth + sigma * normal(g, images.shape)


def seen_by_a_camera(g, images):
    """Gain control, blur, noise, rounding to 8 bits."""
    images = noisy(g, blurred(g, gain_controlled(g, images)))
    return torch.round(images.clamp(0, 1) * 255) / 255
