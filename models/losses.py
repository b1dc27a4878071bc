"""Losses of the heads, each a mean over what it judges."""
import torch
import torch.nn.functional as F

from targets import IGNORED


def point_loss(points, labels):
    return F.cross_entropy(points.float(), labels, ignore_index=IGNORED)


def descriptor_loss(descriptors_a, descriptors_b, at_a, at_b, pair, temperature=0.1, near_px=12.0):
    """InfoNCE both ways. descriptors: N x 64 x H/8 x W/8; at: K x 2 px in the images of index `pair`, the same places in both.
    Every other place of the batch is a wrong answer, except those of the same image nearer than near_px."""
    a, b = sampled(descriptors_a, at_a, pair), sampled(descriptors_b, at_b, pair)
    likeness = a @ b.T / temperature
    same_image = pair[:, None] == pair[None, :]
    excused = same_image & ((torch.cdist(at_a, at_a) < near_px) | (torch.cdist(at_b, at_b) < near_px))
    excused.fill_diagonal_(False)
    likeness = likeness.masked_fill(excused, -1e4)
    right = torch.arange(len(a))
    return 0.5 * (F.cross_entropy(likeness, right) + F.cross_entropy(likeness.T, right))


def sampled(maps, at_px, image, stride=8):
    """Unit descriptors at places in pixels, bilinear between cells."""
    maps = maps.float()
    height, width = maps.shape[2:]
    grid = (at_px + 0.5) / (stride * torch.tensor([width, height], dtype=torch.float32)) * 2 - 1
    columns = []
    for index in range(maps.shape[0]):
        mine = grid[image == index]
        columns.append(F.grid_sample(maps[index : index + 1], mine[None, None], align_corners=False, padding_mode="border")[0, :, 0])
    return F.normalize(torch.cat(columns, 1).T, dim=1)


def line_losses(raw, field, weights):
    """Attraction, distance, direction, ends, junctions and their offsets; raw is the network's map, see pl_net.read_lines."""
    raw = raw.float()
    attraction, geometry, junctions = weights[:, 0], weights[:, 1], weights[:, 2]
    mean = lambda loss, weight: (loss * weight).sum() / weight.sum().clamp(min=1.0)
    unlike = F.binary_cross_entropy_with_logits(raw[:, 0], field[:, 0], reduction="none")
    distance = (10.0 * torch.sigmoid(raw[:, 1]) - field[:, 1]).abs() / 4.0
    direction = 1.0 - (F.normalize(raw[:, 2:4], dim=1, eps=1e-4) * field[:, 2:4]).sum(1)
    # A foot a hair's breadth away has no direction to speak of.
    direction = direction * (field[:, 1] / 1.0).clamp(max=1.0)
    ends = (1.5708 * torch.sigmoid(raw[:, 4:6]) - field[:, 4:6]).abs().sum(1)
    rare = torch.where(field[:, 6] > 0, 8.0, 1.0)
    junction = F.binary_cross_entropy_with_logits(raw[:, 6], field[:, 6], reduction="none") * rare
    offset = (4.0 * torch.sigmoid(raw[:, 7:9]) - 2.0 - field[:, 7:9]).abs().sum(1)
    return {
        "attraction": mean(unlike, attraction), "distance": mean(distance, geometry), "direction": mean(direction, geometry),
        "ends": mean(ends, geometry), "junction": mean(junction, junctions), "offset": 0.25 * mean(offset, field[:, 6])}
