"""Batches for training, each made from its number alone, so that a run that was cut off goes on as if it had not been."""
import numpy as np
import torch

import warps
from photometric import seen_by_a_camera
from targets import line_field, point_labels

PLACES_A_PAIR = 56


class Batches(torch.utils.data.Dataset):
    """Item n: `pairs` pairs of crops of one source image each under a random move and two random gain controls."""

    def __init__(self, sources, seed, pairs, size):
        self.sources, self.seed, self.pairs, self.size = sources, seed, pairs, size

    def __len__(self):
        return 1 << 30

    def __getitem__(self, number):
        rng = np.random.default_rng((self.seed, number))
        pairs = [self._pair(rng) for _ in range(self.pairs)]
        crops = [pair[side] for side in (0, 1) for pair in pairs]
        stack = lambda key: torch.from_numpy(np.stack([crop[key] for crop in crops]))
        return {
            "image": stack("image")[:, None], "labels": stack("labels"), "field": stack("field"), "weights": stack("weights"),
            "at_a": torch.from_numpy(np.concatenate([pair[2] for pair in pairs])),
            "at_b": torch.from_numpy(np.concatenate([pair[3] for pair in pairs])),
            "pair": torch.from_numpy(np.concatenate([np.full(len(pair[2]), i) for i, pair in enumerate(pairs)]))}

    def _pair(self, rng):
        image, points, segments = self.sources.draw(rng)
        height, width = image.shape
        to_a = warps.random_crop(rng, width, height, self.size)
        a_to_b = warps.random_motion(rng, self.size)
        a, shown_a, points_a = self._crop(rng, image, points, segments, to_a)
        b, shown_b, _ = self._crop(rng, image, points, segments, a_to_b @ to_a)
        at_a = self._places(rng, points_a)
        at_b = warps.carried(a_to_b, at_a)
        both = warps.inside(at_b, self.size, self.size, 4.0)
        for at, shown in ((at_a, shown_a), (at_b, shown_b)):
            pixel = np.clip(np.round(at).astype(int), 0, self.size - 1)
            both &= shown[pixel[:, 1], pixel[:, 0]] > 0
        return a, b, at_a[both].astype(np.float32), at_b[both].astype(np.float32)

    def _crop(self, rng, image, points, segments, homography):
        size = self.size
        crop, shown = warps.warped(image, homography, (size, size))
        here = warps.carried(homography, points)
        lines = warps.carried(homography, segments.reshape(-1, 2)).reshape(-1, 4)
        field, weights = line_field(warps.clipped(lines, size, size), shown)
        sides = {"image": seen_by_a_camera(rng, crop), "labels": point_labels(here, shown), "field": field, "weights": weights}
        return sides, shown, here

    def _places(self, rng, points):
        """Key points first, and some places anywhere."""
        points = points[warps.inside(points, self.size, self.size, 4.0)]
        if len(points) > PLACES_A_PAIR:
            points = points[rng.permutation(len(points))[:PLACES_A_PAIR]]
        anywhere = rng.uniform(4, self.size - 5, (max(PLACES_A_PAIR - len(points), 8), 2))
        return np.concatenate([points, anywhere])
