"""Points and segments of images that nobody annotated: what classical detectors find again and again under random moves and gain
controls (homographic adaptation: DeTone et al., SuperPoint, 2018, for points; Pautrat et al., DeepLSD, 2023, for lines)."""
import cv2
import numpy as np
import torch

import warps
from photometric import seen_by_a_camera

CONTRAST_FLOOR = 0.012  # as pl_net.LocalContrast
ANGLE_BINS = 16


def local_contrast(image, reach=40):
    mean = cv2.blur(image, (reach, reach))
    deviation = np.sqrt(np.maximum(cv2.blur(image * image, (reach, reach)) - mean * mean, 0) + CONTRAST_FLOOR**2)
    return np.clip((image - mean) / deviation, -4, 4)


def _move(g, width, height):
    motion = warps.random_motion(g, 1, 1.0)[0].numpy().astype(np.float64)  # of a unit square, then of the image
    scale = np.diag([1.0 / max(width, height), 1.0 / max(width, height), 1.0])
    return np.linalg.inv(scale) @ motion @ scale


def _carried(homography, points):
    return warps.carried(torch.from_numpy(homography)[None], torch.from_numpy(points)[None])[0].numpy()


def _warped(image, homography):
    """The image moved within its frame, and where the frame shows it (uint8)."""
    size = image.shape[1], image.shape[0]
    moved = cv2.warpPerspective(image, homography, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return moved, cv2.warpPerspective(np.ones(image.shape, np.uint8), homography, size, flags=cv2.INTER_NEAREST)


def _by_a_camera(g, image):
    return seen_by_a_camera(g, torch.from_numpy(image)[None, None])[0, 0].numpy()


def _corners(g, image, most):
    smooth = cv2.GaussianBlur(local_contrast(image), (0, 0), float(warps.uniform(g, 1, 0.8, 1.6)))
    strength = cv2.cornerMinEigenVal(smooth, 5)
    best = cv2.dilate(strength, np.ones((7, 7), np.uint8))
    y, x = np.nonzero((strength >= best) & (strength > 1e-6))
    order = np.argsort(-strength[y, x])[:most]
    return np.stack([x[order], y[order]], 1).astype(np.float64)


def repeated_points(g, image, rounds=12, least_share=0.2):
    """Shi-Tomasi corners that come back in at least a share of the rounds, best first: N x 2."""
    height, width = image.shape
    most = width * height // 800
    found, looked = np.zeros_like(image), np.zeros_like(image)
    for number in range(rounds):
        homography = np.eye(3) if number == 0 else _move(g, width, height)
        crop, shown = _warped(image, homography)
        corners = _corners(g, _by_a_camera(g, crop), most)
        corners = corners[shown[corners[:, 1].astype(int), corners[:, 0].astype(int)] > 0]
        votes = np.zeros_like(image)
        back = np.round(_carried(np.linalg.inv(homography), corners)).astype(int)
        back = back[warps.inside(torch.from_numpy(back), width, height).numpy()]
        votes[back[:, 1], back[:, 0]] = 1.0
        found += cv2.dilate(votes, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (3, 3))) + cv2.GaussianBlur(votes, (0, 0), 1.2)
        looked += _warped(np.ones_like(image), np.linalg.inv(homography))[0] if number else 1.0
    share = cv2.GaussianBlur(found, (0, 0), 0.8) / np.maximum(looked, rounds / 3)
    best = cv2.dilate(share, np.ones((9, 9), np.uint8))
    y, x = np.nonzero((share >= best) & (share > least_share))
    order = np.argsort(-share[y, x])[:most]
    return np.stack([x[order], y[order]], 1).astype(np.float64)


def _segments(image):
    found = cv2.createLineSegmentDetector().detect(np.round(np.clip(image, 0, 1) * 255).astype(np.uint8))[0]
    segments = np.zeros((0, 4)) if found is None else found.reshape(-1, 4).astype(np.float64)
    return segments[_lengths(segments) >= 10.0]


def _lengths(segments):
    return np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1])


def _bins(segments):
    angle = np.arctan2(segments[:, 3] - segments[:, 1], segments[:, 2] - segments[:, 0]) % np.pi
    return np.floor(angle / np.pi * ANGLE_BINS).astype(int) % ANGLE_BINS


def _drawn(segments, shape):
    """Where segments lie, a layer for each range of angles: each is also drawn into the two neighbours."""
    layers = np.zeros((ANGLE_BINS, *shape), np.uint8)
    fixed = np.round(segments * 16).astype(int)
    for (x0, y0, x1, y1), middle in zip(fixed, _bins(segments)):
        for k in (-1, 0, 1):
            cv2.line(layers[(middle + k) % ANGLE_BINS], (int(x0), int(y0)), (int(x1), int(y1)), 1, 3, cv2.LINE_8, 4)
    return layers


def _support(layers, segments):
    """For each segment how often, along it, the rounds saw a line of its direction: a list of arrays, one value every 2 px."""
    supports = []
    for segment, layer in zip(segments, _bins(segments)):
        count = max(int(np.hypot(*(segment[2:] - segment[:2])) / 2), 2)
        at = segment[:2] + (np.arange(count)[:, None] + 0.5) / count * (segment[2:] - segment[:2])
        x = np.clip(np.round(at[:, 0]).astype(int), 0, layers.shape[2] - 1)
        y = np.clip(np.round(at[:, 1]).astype(int), 0, layers.shape[1] - 1)
        supports.append(layers[layer, y, x])
    return supports


def _joined(segments, layers, least_share, gap_px=10.0):
    """Joins segments that continue one another where the rounds saw the gap too, longest first; drops what lies on a longer one."""
    segments = segments[np.argsort(-_lengths(segments))]
    alive = np.ones(len(segments), bool)
    for i in range(len(segments)):
        if not alive[i]:
            continue
        changed = True
        while changed:
            changed = False
            a, b = segments[i, :2], segments[i, 2:]
            length = np.hypot(*(b - a))
            along = (b - a) / length
            offset = segments.reshape(-1, 2, 2) - a
            t, across = offset @ along, offset @ np.array([-along[1], along[0]])
            near = (np.abs(across).max(1) < 2.0) & (t.max(1) > -gap_px) & (t.min(1) < length + gap_px) & alive
            near[: i + 1] = False
            for j in np.flatnonzero(near):
                ends = np.array([min(0.0, t[j].min()), max(length, t[j].max())])
                longer = np.concatenate([a + ends[0] * along, a + ends[1] * along])
                # A gap that hardly any round saw as a line stays one.
                if ends[1] - ends[0] > length + 2 and np.mean(_support(layers, longer[None])[0] >= 0.5 * least_share) < 0.95:
                    continue
                segments[i], alive[j], changed = longer, False, True
                break
    return segments[alive]


def repeated_segments(g, image, rounds=6, least_share=0.35, least_px=12.0):
    """Segments that LSD finds in at least a share of the rounds, pieced together: M x 4."""
    height, width = image.shape
    votes, looked, candidates = np.zeros((ANGLE_BINS, height, width), np.float32), np.zeros_like(image), []
    for number in range(rounds):
        homography = np.eye(3) if number == 0 else _move(g, width, height)
        crop, shown = _warped(image, homography)
        segments = _segments(_by_a_camera(g, crop) if number else image)
        inner = cv2.erode(shown, np.ones((9, 9), np.uint8))
        middle = np.round((segments[:, :2] + segments[:, 2:]) / 2).astype(int).clip(0, [width - 1, height - 1])
        segments = segments[inner[middle[:, 1], middle[:, 0]] > 0]  # not the border of what the crop shows
        back = _carried(np.linalg.inv(homography), segments.reshape(-1, 2)).reshape(-1, 4)
        segments = warps.clipped(torch.from_numpy(back), width, height).numpy()
        segments = segments[np.isfinite(segments).all(1)]
        votes += _drawn(segments, image.shape)
        looked += _warped(np.ones_like(image), np.linalg.inv(homography))[0] if number else 1.0
        candidates.append(segments)
    votes /= np.maximum(looked, rounds / 3)
    joined = _joined(np.concatenate(candidates[:2]), votes, least_share)
    share = np.array([support.mean() for support in _support(votes, joined)])
    return joined[(share >= least_share) & (_lengths(joined) >= least_px)]
