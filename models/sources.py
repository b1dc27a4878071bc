"""Images with points and segments to train on, made once from seeds and kept in a folder."""
import json
import pathlib
import subprocess

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


# Scenes of the simulator to train on: seeds from 10000 on, never `plant`, never a row of bench/sequences.yaml.
SIMULATED = {
    "street": "street --seed 10001 --duration 12 --set image_rate=1 --set length=400",
    "room": "room --seed 10002 --duration 24 --set image_rate=0.5 --set rig=inspection",
    "stairs": "stairs --seed 10003 --duration 14 --set image_rate=0.5 --set rig=inspection",
    "corridor": "corridor --seed 10004 --duration 14 --set image_rate=0.5 --set rig=inspection --set length=40",
}
LEAST_EDGE_GREY = 5.0  # an edge of the scene that shows less than this in the image is none of the image's


def simulate(folder, program):
    for name, scene in SIMULATED.items():
        if not (folder / name / "frames.json").exists():
            common = "--set images=agc --set scans=0 --truth edges --overwrite --frames"
            subprocess.run([program, "simulate", *scene.split(), *common.split(), str(folder / name)], check=True)


def label_simulated(folder, frames, seed):
    """The scene's own edges where they show; points as in stills."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, still in enumerate(sorted(frames.glob("*/*.grey.png"))):
        path = folder / f"{still.parent.name}_{still.name.split('.')[0]}.npz"
        if path.exists():
            continue
        grey = cv2.imread(str(still), cv2.IMREAD_GRAYSCALE).astype(np.float32)
        edges = json.loads(still.with_name(still.name.replace("grey.png", "edges.json")).read_text())["edges"]
        pieces = [piece for edge in edges for piece in _straight(np.array(edge["line_px"]))]
        shown = [piece for piece in pieces if _shows(grey, piece)]
        points = repeated_points(np.random.default_rng((seed, number)), grey / 255, rounds=6)
        _keep(path, grey / 255, points, np.array(shown).reshape(-1, 4))


def _straight(line, most_bend_px=1.0):
    """A polyline as one segment where it hardly bends, else piece by piece."""
    along = (line[-1] - line[0]) / max(np.hypot(*(line[-1] - line[0])), 1e-6)
    bend = np.abs((line - line[0]) @ np.array([-along[1], along[0]])).max()
    ends = [(line[0], line[-1])] if bend < most_bend_px else zip(line[:-1], line[1:])
    return [np.concatenate(pair) for pair in ends]


def _shows(grey, segment):
    a, b = segment[:2], segment[2:]
    length = np.hypot(*(b - a))
    if length < 8:
        return False
    at = a + np.linspace(0.05, 0.95, max(int(length / 2), 4))[:, None] * (b - a)
    normal = np.array([-(b - a)[1], (b - a)[0]]) / length
    sides = [cv2.remap(grey, *np.float32((at + off * normal).T[:, :, None]), cv2.INTER_LINEAR) for off in (-2.0, 2.0)]
    return abs(float((sides[0] - sides[1]).mean())) > LEAST_EDGE_GREY
