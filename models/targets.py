"""What the network should say about images whose points and segments are known. See pl_net.read_lines for the line map.

Points (B x K x 2) and segments (B x M x 4) are in pixels, NaN where there is none; `shown` (B x H x W, bool) is where a crop shows
its source.
"""
import torch
import torch.nn.functional as F

from pl_net import ATTRACTION_PX, END_SCALE_PX, point_channel, score_map
from warps import carried, clipped, inside, pixels, sampled

IGNORED = -100  # PyTorch's cross-entropy skips this label
LEAST_SEGMENT_PX = 8.0
MOST_SEGMENTS = 160  # of a crop, the longest


def _cells(shown, stride):
    """Cells that lie in what is shown altogether."""
    return -F.max_pool2d(-shown[:, None].float(), stride)[:, 0] > 0.5


def point_labels(points, shown):
    """B x H/8 x W/8 labels: the channel of the pixel that a cell's first point falls on, 64 where there is none, IGNORED where the
    crop shows nothing. Points come best first."""
    count, height, width = shown.shape
    nearest = torch.round(torch.nan_to_num(points, -1e6)).long()
    x, y = nearest[..., 0], nearest[..., 1]
    here = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    cell = torch.where(here, (y // 8) * (width // 8) + x // 8, height * width // 64)
    rank = torch.arange(points.shape[1], device=points.device).expand(count, -1)
    first = torch.full((count, height * width // 64 + 1), points.shape[1], device=points.device)
    first = first.scatter_reduce(1, cell, rank, "amin")[:, :-1]
    channel = F.pad(point_channel(x % 8, y % 8), (0, 1), value=64)
    labels = torch.gather(channel, 1, first).reshape(count, height // 8, width // 8)
    return torch.where(_cells(shown, 8), labels, IGNORED)


def shows_something(images, reach=10, least_grey=3.0):
    """Where greys within `reach` px differ: B x H x W, bool. Elsewhere the camera saw nothing but black or white."""
    size = 2 * reach + 1
    # Rows, then columns: a processor takes eight times as long over the square at once.
    highest = lambda maps: F.max_pool2d(F.max_pool2d(maps, (1, size), 1, (0, reach)), (size, 1), 1, (reach, 0))
    return ((highest(images) + highest(-images)) * 255 > least_grey)[:, 0]


def agreed_labels(raw, raw_other, to_other, shown, shown_other, labels, near_px=4):
    """Labels that two views of a place agree on: as many of a crop as `labels` names, where the product of both views' scores is
    highest. raw: the network's point maps of the crops and of the other views; to_other: homographies from the one to the other."""
    count, height, width = shown.shape
    blur = lambda scores: F.avg_pool2d(scores, 3, stride=1, padding=1)
    there = carried(to_other, pixels(height, width, shown.device))
    product = blur(score_map(raw))[:, 0] * sampled(blur(score_map(raw_other)), there).reshape(shown.shape)
    both = shown & (sampled(shown_other[:, None].float(), there).reshape(shown.shape) > 0.99)
    both &= inside(there, width, height, 2.0).reshape(shown.shape)
    best = F.max_pool2d(product[:, None], 2 * near_px + 1, stride=1, padding=near_px)[:, 0]
    peaks = torch.where(both & (product >= best), product, 0.0).flatten(1)
    value, at = peaks.topk(height * width // 256, dim=1)
    wanted = ((labels >= 0) & (labels < 64) & _cells(both, 8)).sum((1, 2))
    taken = (torch.arange(at.shape[1], device=at.device) < wanted[:, None]) & (value > 0)
    points = torch.stack([at % width, at // width], -1).float()
    return point_labels(torch.where(taken[..., None], points, torch.nan), both)


def line_field(segments, shown):
    """The line map (B x 9 x H/4 x W/4) and weights (B x 3 x H/4 x W/4): of attraction, of the segment's geometry, of junctions."""
    segments = clipped(segments, shown.shape[2], shown.shape[1])
    lengths = torch.nan_to_num((segments[..., 2:] - segments[..., :2]).norm(dim=-1), 0.0)
    lengths, longest = lengths.topk(min(MOST_SEGMENTS, lengths.shape[1]), dim=1)
    segments = torch.gather(segments, 1, longest[..., None].expand(-1, -1, 4))
    segments = torch.where(lengths[..., None] >= LEAST_SEGMENT_PX, segments, torch.nan)
    whole = _cells(shown, 4).float()
    field = torch.cat([_attraction(segments, lengths, whole.shape[1:]), _junctions(segments, whole.shape[1:])], 1)
    return field, torch.stack([whole, field[:, 0] * whole, whole], 1)


def _attraction(segments, lengths, shape):
    """Each cell belongs to the segment nearest to it among those that it has its foot on. Channels 0 to 5."""
    cells = pixels(*shape, segments.device) * 4 + 1.5
    along = (segments[..., 2:] - segments[..., :2]) / lengths[..., None].clamp(min=1e-6)
    x = cells[:, :, None, 0] - segments[:, None, :, 0]
    y = cells[:, :, None, 1] - segments[:, None, :, 1]
    c, s = along[:, None, :, 0], along[:, None, :, 1]
    t, across = x * c + y * s, y * c - x * s
    reaches = (t >= 0) & (t <= lengths[:, None])  # false for NaN
    distance, which = torch.where(reaches, across.abs(), torch.inf).min(2)
    of_it = lambda values: torch.gather(values.expand(t.shape), 2, which[..., None])[..., 0]
    t, across, c, s, length = (of_it(values) for values in (t, across, c, s, lengths[:, None]))
    # To the foot: against the side that the cell lies on. A quarter turn from x towards y of that direction points along the
    # segment for one side, against it for the other.
    side = torch.where(across > 0, 1.0, -1.0)
    ahead = torch.where(side > 0, length - t, t)
    channels = (torch.ones_like(t), distance, side * s, -side * c, torch.atan(ahead / END_SCALE_PX), torch.atan((length - ahead) / END_SCALE_PX))
    mine = distance < ATTRACTION_PX
    return torch.stack([torch.where(mine, channel, 0.0) for channel in channels], 1).reshape(-1, 6, *shape)


def _junctions(segments, shape):
    """Whether a segment ends in a cell, and where from its centre. Channels 6 to 8."""
    count, (height, width) = len(segments), shape
    ends = segments.reshape(count, -1, 2)
    cell = torch.floor((torch.nan_to_num(ends, -1e6) + 0.5) / 4).long()
    j, i = cell[..., 0], cell[..., 1]
    here = (i >= 0) & (i < height) & (j >= 0) & (j < width)
    index = torch.where(here, i * width + j, height * width)
    values = torch.cat([torch.ones_like(ends[..., :1]), ends - (4 * cell + 1.5)], -1)
    values = torch.where(here[..., None], values, 0.0)
    field = torch.zeros(count, height * width + 1, 3, device=segments.device)
    field = field.scatter(1, index[..., None].expand(-1, -1, 3), values)
    # Two ends in one cell may have left numbers of both; each is within the cell.
    return field[:, :-1].transpose(1, 2).reshape(count, 3, height, width)
