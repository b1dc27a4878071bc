"""Losses of the heads, each a mean over what it judges."""
import math

import torch
import torch.nn.functional as F

from pl_net import ATTRACTION_PX
from targets import IGNORED
from warps import sampled

NEAR_PX = 12.0


def point_loss(points, labels):
    return F.cross_entropy(points.float(), labels, ignore_index=IGNORED)


def descriptor_loss(descriptors_a, descriptors_b, at_a, at_b, known, temperature=0.1):
    """InfoNCE both ways. descriptors: B x 64 x H/8 x W/8; at: B x K x 2 px, the same places in both; known: B x K, which of them
    both views show. Every other place of the batch is a wrong answer, except those of the same image nearer than NEAR_PX."""
    a, b = described(descriptors_a, at_a), described(descriptors_b, at_b)
    likeness = a @ b.T / temperature
    near = (torch.cdist(at_a, at_a) < NEAR_PX) | (torch.cdist(at_b, at_b) < NEAR_PX)
    likeness = likeness.masked_fill(torch.block_diag(*near).fill_diagonal_(False), -1e4)
    known = known.flatten()
    right, weight = torch.arange(len(a), device=a.device), known.float() / known.sum().clamp(min=1)
    both_ways = (likeness.masked_fill(~known[None], -1e4), likeness.T.masked_fill(~known[None], -1e4))
    return 0.5 * sum((F.cross_entropy(each, right, reduction="none") * weight).sum() for each in both_ways)


def described(maps, at_px, stride=8):
    """Unit descriptors at places in pixels, bilinear between cells: (B K) x 64."""
    cells = (at_px + 0.5) / stride - 0.5
    return F.normalize(sampled(maps.float(), cells).transpose(1, 2).flatten(0, 1), dim=1)


def line_losses(raw, field, weights):
    """Attraction, distance, direction, ends, junctions and their offsets; raw is the network's map, see pl_net.read_lines."""
    raw = raw.float()
    attraction, geometry, junctions = weights[:, 0], weights[:, 1], weights[:, 2]
    mean = lambda loss, weight: (loss * weight).sum() / weight.sum().clamp(min=1.0)
    unlike = F.binary_cross_entropy_with_logits(raw[:, 0], field[:, 0], reduction="none")
    distance = (ATTRACTION_PX * torch.sigmoid(raw[:, 1]) - field[:, 1]).abs() / 4.0
    direction = 1.0 - (F.normalize(raw[:, 2:4], dim=1, eps=1e-4) * field[:, 2:4]).sum(1)
    # A foot a hair's breadth away has no direction to speak of.
    direction = direction * field[:, 1].clamp(max=1.0)
    ends = (0.5 * math.pi * torch.sigmoid(raw[:, 4:6]) - field[:, 4:6]).abs().sum(1)
    rare = torch.where(field[:, 6] > 0, 8.0, 1.0)
    junction = F.binary_cross_entropy_with_logits(raw[:, 6], field[:, 6], reduction="none") * rare
    offset = (4.0 * torch.sigmoid(raw[:, 7:9]) - 2.0 - field[:, 7:9]).abs().sum(1)
    return {
        "attraction": mean(unlike, attraction), "distance": mean(distance, geometry), "direction": mean(direction, geometry),
        "ends": mean(ends, geometry), "junction": mean(junction, junctions), "offset": 0.25 * mean(offset, field[:, 6])}
