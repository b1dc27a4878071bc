"""Images with points and segments to train on, made once from seeds and kept in a folder."""
import pathlib

import cv2
import numpy as np

from adaptation import repeated_points, repeated_segments
from synthetic import make_scene

HELD_OUT = 10  # one still of HIT-UAV in ten is never trained on


class Sources:
    """Groups of examples; each draw picks a group by its weight, then an example."""

    def __init__(self, groups):
        self.groups = [(weight, examples) for weight, examples in groups if weight > 0 and examples]
        total = sum(weight for weight, _ in self.groups)
        self.shares = [weight / total for weight, _ in self.groups]

    def draw(self, rng):
        examples = self.groups[rng.choice(len(self.groups), p=self.shares)][1]
        image, points, segments = examples[rng.integers(len(examples))]
        return image.astype(np.float32) / 255, points, segments


def read(path):
    with np.load(path) as file:
        return file["image"], file["points"], file["segments"]


def all_in(folder):
    return [read(path) for path in sorted(pathlib.Path(folder).glob("*.npz"))]


def _keep(path, image, points, segments):
    partial = path.with_suffix(".partial.npz")
    np.savez(partial, image=np.round(np.clip(image, 0, 1) * 255).astype(np.uint8), points=points, segments=segments)
    partial.rename(path)


def make_shapes(folder, count, seed):
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(count):
        path = folder / f"{number:05d}.npz"
        if not path.exists():
            _keep(path, *make_scene(np.random.default_rng((seed, number))))


def label(folder, stills, seed, every=1):
    """Labels by homographic adaptation every n-th of some stills."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, still in list(enumerate(stills))[::every]:
        path = folder / f"{still.stem}.npz"
        if path.exists():
            continue
        image = cv2.imread(str(still), cv2.IMREAD_GRAYSCALE).astype(np.float32) / 255
        rng = np.random.default_rng((seed, number))
        _keep(path, image, repeated_points(rng, image), repeated_segments(rng, image))


def hit_uav(folder, held_out=False):
    """The stills that may be trained on, or those held out."""
    stills = sorted(pathlib.Path(folder).glob("*.jpg"))
    return [still for i, still in enumerate(stills) if (i % HELD_OUT == 0) == held_out]
