"""What the network should say about an image whose points and segments are known. See pl_net.read_lines for the line map."""
import numpy as np

from pl_net import ATTRACTION_PX, END_SCALE_PX, point_channel

IGNORED = -100  # PyTorch's cross-entropy skips this label
LEAST_SEGMENT_PX = 8.0


def point_labels(points, valid):
    """H/8 x W/8 labels: the channel of the pixel that a cell's first point falls on, 64 where there is none, IGNORED where the
    crop shows nothing. points: N x 2, best first."""
    height, width = valid.shape
    cells = valid.reshape(height // 8, 8, width // 8, 8).min((1, 3))
    labels = np.where(cells > 0, 64, IGNORED).astype(np.int64)
    for x, y in np.round(points).astype(int)[::-1]:
        if 0 <= x < width and 0 <= y < height and labels[y // 8, x // 8] != IGNORED:
            labels[y // 8, x // 8] = point_channel(x % 8, y % 8)
    return labels


def line_field(segments, valid):
    """The line map (9 x H/4 x W/4, float32) and weights (3 x H/4 x W/4): of attraction, of the segment's geometry, of junctions."""
    height, width = valid.shape[0] // 4, valid.shape[1] // 4
    field = np.zeros((9, height, width), np.float32)
    weights = np.zeros((3, height, width), np.float32)
    weights[0] = weights[2] = valid.reshape(height, 4, width, 4).min((1, 3))
    if len(segments):
        lengths = np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1])
        segments = segments[lengths >= LEAST_SEGMENT_PX]
    if len(segments):
        _add_attraction(field, weights, segments)
        _add_junctions(field, segments)
    return field, weights


def _add_attraction(field, weights, segments):
    """Each cell belongs to the segment nearest to it among those that it has its foot on."""
    height, width = field.shape[1:]
    nearest = np.full((height, width), ATTRACTION_PX, np.float32)
    boxes_low = np.floor((segments.reshape(-1, 2, 2).min(1) - ATTRACTION_PX - 1.5) / 4).astype(int).clip(0)
    boxes_high = np.ceil((segments.reshape(-1, 2, 2).max(1) + ATTRACTION_PX - 1.5) / 4).astype(int) + 1
    rows, columns = (np.arange(height, dtype=np.float32) * 4 + 1.5)[:, None], (np.arange(width, dtype=np.float32) * 4 + 1.5)[None]
    for (x0, y0, x1, y1), (j0, i0), (j1, i1) in zip(segments.astype(np.float32), boxes_low, boxes_high):
        box = slice(i0, i1), slice(j0, j1)
        length = np.hypot(x1 - x0, y1 - y0)
        c, s = (x1 - x0) / length, (y1 - y0) / length
        x, y = columns[:, j0:j1] - x0, rows[i0:i1] - y0
        t, across = x * c + y * s, y * c - x * s
        distance = np.abs(across)
        mine = (t >= 0) & (t <= length) & (distance < nearest[box])
        if not mine.any():
            continue
        t, side = t[mine], np.where(across[mine] > 0, np.float32(1), np.float32(-1))
        nearest[box][mine] = distance[mine]
        # To the foot: against the side that the cell lies on. A quarter turn from x towards y of that direction points along the
        # segment for one side, against it for the other.
        ahead = np.where(side > 0, length - t, t)
        values = (1.0, distance[mine], side * s, -side * c, np.arctan(ahead / END_SCALE_PX), np.arctan((length - ahead) / END_SCALE_PX))
        for layer, value in zip(field, values):
            layer[box][mine] = value
    weights[1] = field[0] * weights[0]


def _add_junctions(field, segments):
    height, width = field.shape[1:]
    for x, y in segments.reshape(-1, 2):
        j, i = int((x + 0.5) // 4), int((y + 0.5) // 4)
        if 0 <= i < height and 0 <= j < width:
            field[6, i, j] = 1.0
            field[7, i, j], field[8, i, j] = x - (4 * j + 1.5), y - (4 * i + 1.5)
