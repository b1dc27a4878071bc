"""Random homographies, and points and segments under them. A homography maps pixels of the source to pixels of the crop."""
import cv2
import numpy as np


def carried(homography, points):
    points = np.asarray(points, np.float64).reshape(-1, 1, 2)
    return cv2.perspectiveTransform(points, homography).reshape(-1, 2) if len(points) else np.zeros((0, 2))


def _about(centre, scale, angle, shift, perspective):
    """Turns, scales and slants about a centre, then shifts."""
    c, s = scale * np.cos(angle), scale * np.sin(angle)
    there = np.array([[1, 0, -centre[0]], [0, 1, -centre[1]], [0, 0, 1.0]])
    turn = np.array([[c, -s, 0], [s, c, 0], [perspective[0], perspective[1], 1.0]])
    back = np.array([[1, 0, centre[0] + shift[0]], [0, 1, centre[1] + shift[1]], [0, 0, 1.0]])
    return back @ turn @ there


def random_crop(rng, width, height, size):
    """From a width x height image to a size x size crop: upright within some degrees, shrunk or grown a little."""
    scale = np.exp(rng.uniform(np.log(0.75), np.log(1.5)))
    reach = 0.5 * size / scale
    centre = [rng.uniform(min(reach, side / 2), max(side - reach, side / 2)) for side in (width, height)]
    angle = rng.normal(0, 0.12) if rng.random() < 0.8 else rng.uniform(-np.pi, np.pi)
    to_crop = np.array([[1, 0, size / 2 - centre[0]], [0, 1, size / 2 - centre[1]], [0, 0, 1.0]])
    mirror = np.diag([-1.0 if rng.random() < 0.5 else 1.0, 1.0, 1.0])
    mirror[0, 2] = size - 1 if mirror[0, 0] < 0 else 0
    return mirror @ _about((size / 2, size / 2), scale, angle, (0, 0), rng.normal(0, 0.08, 2) / size) @ to_crop


def random_motion(rng, size):
    """What a camera's move does to a crop."""
    scale = np.exp(rng.normal(0, 0.18))
    angle = rng.normal(0, 0.2) if rng.random() < 0.8 else rng.uniform(-0.8, 0.8)
    return _about((size / 2, size / 2), scale, angle, rng.normal(0, 0.1, 2) * size, rng.normal(0, 0.12, 2) / size)


def warped(image, homography, size):
    """The crop, and where it shows the source (uint8)."""
    flags = cv2.INTER_AREA if abs(np.linalg.det(homography[:2, :2])) < 0.3 else cv2.INTER_LINEAR
    crop = cv2.warpPerspective(image, homography, size, flags=flags, borderMode=cv2.BORDER_REPLICATE)
    ones = np.ones(image.shape[:2], np.uint8)
    return crop, cv2.warpPerspective(ones, homography, size, flags=cv2.INTER_NEAREST)


def inside(points, width, height, margin=0.0):
    return ((points >= margin) & (points <= np.array([width - 1.0, height - 1.0]) - margin)).all(1)


def clipped(segments, width, height):
    """Segments (M x 4) cut to an image by Liang and Barsky's method; without those that lie outside."""
    kept = []
    for x0, y0, x1, y1 in segments:
        d, first, last = np.array([x1 - x0, y1 - y0]), 0.0, 1.0
        for p, q in ((-d[0], x0), (d[0], width - 1 - x0), (-d[1], y0), (d[1], height - 1 - y0)):
            if p < 0:
                first = max(first, q / p)
            elif p > 0:
                last = min(last, q / p)
            elif q < 0:
                last = -1.0
        if last > first:
            kept.append([x0 + first * d[0], y0 + first * d[1], x0 + last * d[0], y0 + last * d[1]])
    return np.array(kept).reshape(-1, 4)
