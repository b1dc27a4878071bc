"""Drawn scenes whose corners and edges are known: facades, boxes, poles, wires, polygons, chequers, with blobs before and behind.

A scene is (image, points, segments): image H x W float32 0..1, points N x 2 and segments M x 4 (x0 y0 x1 y1) in pixels, (0, 0) the
centre of the top left pixel. Corners and stretches of edges that something hides or that hardly stand out are not listed.
"""
import cv2
import numpy as np

LEAST_CONTRAST = 0.035  # of an edge, across three pixels; greys are 0..1
LEAST_LENGTH_PX = 9.0
FINER = 2  # pixels are drawn this much smaller and averaged


class Canvas:
    def __init__(self, rng, width, height):
        self.rng, self.width, self.height = rng, width, height
        self.grey = _cloud(rng, width * FINER, height * FINER) * rng.uniform(0.0, 0.35) + rng.uniform(0.15, 0.85)
        self.owner = np.zeros(self.grey.shape, np.int32)
        self.faces = [None]  # polygon of each owner; None: it has no corners

    def fill(self, polygon, level, corners=True):
        """Covers a polygon (N x 2, px) with a grey that slopes a little."""
        fine = np.round((np.asarray(polygon, np.float64) + 0.5) * FINER - 0.5).astype(np.int32)
        x0, y0 = np.maximum(fine.min(0), 0)
        x1, y1 = np.minimum(fine.max(0) + 1, [self.grey.shape[1], self.grey.shape[0]])
        if x1 - x0 < 2 or y1 - y0 < 2:
            return
        mask = np.zeros((y1 - y0, x1 - x0), np.uint8)
        cv2.fillPoly(mask, [fine - [x0, y0]], 1)
        slope = self.rng.normal(0.0, 0.06, 2) if self.rng.random() < 0.5 else (0.0, 0.0)
        ramp = level + slope[0] * np.linspace(-1, 1, x1 - x0)[None, :] + slope[1] * np.linspace(-1, 1, y1 - y0)[:, None]
        inside = mask > 0
        self.grey[y0:y1, x0:x1][inside] = ramp[inside]
        self.owner[y0:y1, x0:x1][inside] = len(self.faces)
        self.faces.append(np.asarray(polygon, np.float64) if corners else None)

    def level_unlike(self, level):
        return float(np.clip(level + self.rng.choice([-1, 1]) * self.rng.uniform(0.06, 0.45), 0.0, 1.0))

    def place(self):
        return self.rng.uniform([0, 0], [self.width, self.height])


def _cloud(rng, width, height):
    """Smooth noise of mean 0 and about unit size."""
    total = np.zeros((height, width), np.float32)
    for cells in (3, 6, 24):
        small = rng.normal(0.0, 3.0 / (cells + 1), (cells, cells)).astype(np.float32)
        total += cv2.resize(small, (width, height), interpolation=cv2.INTER_CUBIC)
    return total


def _turned(points, angle, centre):
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points) @ np.array([[c, s], [-s, c]]) + centre


def _quad(rng, centre, size, skew=0.25):
    """A rectangle seen at a slant, in order around it."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * size / 2.0
    corners = corners + rng.uniform(-skew, skew, (4, 2)) * np.min(size)
    return _turned(corners, rng.normal(0.0, 0.25), centre)


def _through(quad, unit_points):
    """Points of the unit square carried into a quadrangle by its homography."""
    unit = np.float32([[0, 0], [1, 0], [1, 1], [0, 1]])
    homography = cv2.getPerspectiveTransform(unit, quad.astype(np.float32))
    return cv2.perspectiveTransform(np.asarray(unit_points, np.float64).reshape(-1, 1, 2), homography).reshape(-1, 2)


def _rectangle(x0, y0, x1, y1):
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]


def draw_facade(canvas):
    rng = canvas.rng
    quad = _quad(rng, canvas.place(), rng.uniform(70, 260, 2))
    wall = rng.uniform(0.1, 0.9)
    pane = canvas.level_unlike(wall)
    canvas.fill(quad, wall)
    columns, rows = rng.integers(1, 6, 2)
    wide, high = rng.uniform(0.3, 0.75, 2)
    for i in range(columns):
        for j in range(rows):
            x, y = (i + 0.5) / columns, (j + 0.5) / rows
            window = _rectangle(x - wide / columns / 2, y - high / rows / 2, x + wide / columns / 2, y + high / rows / 2)
            if rng.random() < 0.9:
                canvas.fill(_through(quad, window), np.clip(pane + rng.normal(0, 0.03), 0, 1))


def draw_chequers(canvas):
    rng = canvas.rng
    quad = _quad(rng, canvas.place(), rng.uniform(60, 180, 2))
    columns, rows = rng.integers(2, 7, 2)
    dark = rng.uniform(0.05, 0.95)
    light = canvas.level_unlike(dark)
    for i in range(columns):
        for j in range(rows):
            cell = _rectangle(i / columns, j / rows, (i + 1) / columns, (j + 1) / rows)
            canvas.fill(_through(quad, cell), light if (i + j) % 2 else dark)


def draw_box(canvas):
    """Three faces of a cuboid."""
    rng = canvas.rng
    corner = canvas.place()
    angles = np.array([0.3, 2.5, 4.7]) + rng.uniform(-0.35, 0.35, 3)
    a, b, c = (rng.uniform(18, 110) * np.array([np.cos(t), np.sin(t)]) for t in angles)
    level = rng.uniform(0.1, 0.9)
    for u, v in ((a, b), (b, c), (c, a)):
        canvas.fill([corner, corner + u, corner + u + v, corner + v], level)
        level = canvas.level_unlike(level)


def draw_bar(canvas):
    """A pole, pipe, beam or wire."""
    rng = canvas.rng
    length, width = rng.uniform(40, 360), rng.choice([1.5, 2.5, 4.0, 8.0, 14.0]) * rng.uniform(0.8, 1.3)
    angle = rng.choice([0.0, np.pi / 2]) + rng.normal(0, 0.12) if rng.random() < 0.6 else rng.uniform(0, np.pi)
    bar = np.array(_rectangle(-length / 2, -width / 2, length / 2, width / 2))
    canvas.fill(_turned(bar, angle, canvas.place()), rng.uniform(0.02, 0.98))


def draw_polygon(canvas):
    rng = canvas.rng
    count = rng.integers(3, 8)
    angles = np.sort(rng.uniform(0, 2 * np.pi, count))
    radii = rng.uniform(12, 90) * rng.uniform(0.5, 1.0, count)
    canvas.fill(canvas.place() + radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], 1), rng.uniform(0.05, 0.95))


def draw_blob(canvas):
    """Something round: it hides edges and has none that count."""
    rng = canvas.rng
    angles = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    size = rng.uniform(5, 60, 2)
    outline = np.stack([size[0] * np.cos(angles), size[1] * np.sin(angles)], 1)
    canvas.fill(_turned(outline, rng.uniform(0, np.pi), canvas.place()), rng.uniform(0.05, 0.95), corners=False)


def _sample(image, points):
    x = np.clip(np.round(points[:, 0]).astype(int), 0, image.shape[1] - 1)
    y = np.clip(np.round(points[:, 1]).astype(int), 0, image.shape[0] - 1)
    return image[y, x]


def _visible_runs(image, owner, face, index, a, b):
    """Stretches of the edge a-b of a face that are seen and stand out, as pairs of shares of its length; whether each end is."""
    length = np.hypot(*(b - a))
    count = max(int(length / 2.0), 2)
    shares = (np.arange(count) + 0.5) / count
    along = (b - a) / length
    normal = np.array([-along[1], along[0]])
    if cv2.pointPolygonTest(face.astype(np.float32), tuple(float(v) for v in (a + b) / 2 + 0.5 * normal), False) < 0:
        normal = -normal
    at = a + shares[:, None] * (b - a)
    inner, outer = at + 1.6 * normal, at - 1.6 * normal
    seen = _sample(owner, (at + 1.0 * normal + 0.5) * FINER - 0.5) == index
    seen &= np.abs(_sample(image, inner) - _sample(image, outer)) > LEAST_CONTRAST
    seen &= (at >= 1).all(1) & (at[:, 0] < image.shape[1] - 1.5) & (at[:, 1] < image.shape[0] - 1.5)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], seen, [False]]).astype(np.int8)))
    runs = [(first / count, last / count) for first, last in edges.reshape(-1, 2) if (last - first) / count * length >= LEAST_LENGTH_PX]
    near = min(3, count)
    return runs, bool(seen[:near].all()), bool(seen[-near:].all())


def _truth(canvas, image):
    points, segments = [], []
    for index, face in enumerate(canvas.faces):
        if face is None:
            continue
        ends = []
        for k in range(len(face)):
            a, b = face[k], face[(k + 1) % len(face)]
            runs, at_a, at_b = _visible_runs(image, canvas.owner, face, index, a, b)
            segments += [np.concatenate([a + s * (b - a), a + e * (b - a)]) for s, e in runs]
            ends.append((at_a, at_b))
        # A corner counts where both of its edges are seen right up to it.
        points += [face[k] for k in range(len(face)) if ends[k][0] and ends[k - 1][1]]
    return _distinct_points(np.array(points).reshape(-1, 2)), _distinct_segments(np.array(segments).reshape(-1, 4))


def _distinct_points(points, least_px=3.0):
    kept = np.zeros((0, 2))
    for point in points:
        if not len(kept) or np.min(np.hypot(*(kept - point).T)) > least_px:
            kept = np.vstack([kept, point])
    return kept


def _distinct_segments(segments, least_px=2.5):
    """Two faces list the edge that they share twice."""
    kept = np.zeros((0, 4))
    order = np.argsort(-np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]))
    for segment in segments[order]:
        turned = np.abs(kept - segment[[2, 3, 0, 1]]).max(1) if len(kept) else np.zeros(0)
        same = np.abs(kept - segment).max(1) if len(kept) else np.zeros(0)
        if not len(kept) or min(turned.min(), same.min()) > least_px:
            kept = np.vstack([kept, segment])
    return kept


def make_scene(rng, width=320, height=256):
    canvas = Canvas(rng, width, height)
    shapes = [draw_facade, draw_chequers, draw_box, draw_bar, draw_polygon, draw_blob]
    for shape in rng.choice(len(shapes), rng.integers(4, 13), p=[0.26, 0.06, 0.2, 0.26, 0.12, 0.1]):
        shapes[shape](canvas)
    image = cv2.resize(canvas.grey.astype(np.float32), (width, height), interpolation=cv2.INTER_AREA)
    points, segments = _truth(canvas, image)
    return np.clip(image, 0.0, 1.0), points, segments
