"""Images with points and segments to train on, made once from seeds and kept in a folder."""
import concurrent.futures
import json
import pathlib
import subprocess

import cv2
import numpy as np
import torch

from adaptation import repeated_points, repeated_segments
from synthetic import make_scene

HELD_OUT = 10  # one still of HIT-UAV in ten is never trained on

# Scenes of the simulator to train on: seeds from 10000 on, never `plant`, never a row of bench/sequences.yaml.
THERMAL, VISIBLE = "--set rig=inspection", "--set rig=hilti2022"
SIMULATED = {
    "room_1": f"room --seed 10002 --duration 50 {THERMAL}",
    "room_2": f"room --seed 10012 --duration 50 {THERMAL} --set people=2",
    "stairs_1": f"stairs --seed 10003 --duration 30 {THERMAL}",
    "corridor_1": f"corridor --seed 10004 --duration 30 {THERMAL} --set length=40",
    "field_1": f"field --seed 10005 --duration 25 {THERMAL}",
    "street_1": "street --seed 10001 --duration 40 --set rig=ntu4dradlm --set length=400 --set cars=6 --set people=6",
    "street_2": "street --seed 10011 --duration 40 --set rig=ntu4dradlm --set length=400",
    "room_3": f"room --seed 10022 --duration 40 {VISIBLE}",
    "room_4": f"room --seed 10032 --duration 30 {VISIBLE} --set light=night",
    "stairs_2": f"stairs --seed 10013 --duration 25 {VISIBLE}",
    "corridor_2": f"corridor --seed 10014 --duration 20 {VISIBLE} --set light=night --set bare=1 --set length=40",
    "street_3": f"street --seed 10021 --duration 30 {VISIBLE} --set length=300",
}
LEAST_EDGE_GREY = 5.0  # an edge of the scene that shows less than this in the image is none of the image's


def read(path):
    with np.load(path) as file:
        return cv2.imdecode(file["jpeg"], cv2.IMREAD_GRAYSCALE), file["points"], file["segments"]


def all_in(folder):
    return [read(path) for path in sorted(pathlib.Path(folder).glob("*.npz"))]


def make_all(folder, make, jobs, processes):
    """Calls make(*job) for each job, a name and arguments, whose file is not there yet, and keeps what it returns."""
    folder.mkdir(parents=True, exist_ok=True)
    missing = [(name, *arguments) for name, *arguments in jobs if not (folder / f"{name}.npz").exists()]
    with concurrent.futures.ProcessPoolExecutor(processes, initializer=_alone) as pool:
        for (name, *_), example in zip(missing, pool.map(make, *zip(*(job[1:] for job in missing)), chunksize=4) if missing else ()):
            _keep(folder / f"{name}.npz", *example)


def _alone():
    torch.set_num_threads(1)
    cv2.setNumThreads(1)


def _keep(path, image, points, segments):
    partial = path.with_suffix(".partial")
    jpeg = cv2.imencode(".jpg", np.round(np.clip(image, 0, 1) * 255).astype(np.uint8), [cv2.IMWRITE_JPEG_QUALITY, 90])[1]
    with open(partial, "wb") as file:
        np.savez_compressed(file, jpeg=jpeg, points=np.float32(points), segments=np.float32(segments))
    partial.rename(path)


def shape(*seed):
    return make_scene(np.random.default_rng(seed))


def still(path, *seed):
    """A photograph, labelled by homographic adaptation."""
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE).astype(np.float32) / 255
    g = _generator(seed)
    return image, repeated_points(g, image), repeated_segments(g, image)


def simulated_still(path, *seed):
    """The scene's own edges where they show; points as in photographs."""
    grey = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE).astype(np.float32)
    edges = json.loads(path.with_name(path.name.replace("grey.png", "edges.json")).read_text())["edges"]
    pieces = [piece for edge in edges for piece in _straight(np.array(edge["line_px"]))]
    shown = [piece for piece in pieces if _shows(grey, piece)]
    return grey / 255, repeated_points(_generator(seed), grey / 255), np.array(shown).reshape(-1, 4)


def _generator(seed):
    return torch.Generator().manual_seed((seed[0] << 32) + seed[1])


def hit_uav(folder, held_out=False):
    """The stills that may be trained on, or those held out."""
    stills = sorted(pathlib.Path(folder).glob("*.jpg"))
    return [path for i, path in enumerate(stills) if (i % HELD_OUT == 0) == held_out]


def simulate(folder, program):
    """Renders one image a second of each scene; the paths of all of them."""
    for name, scene in SIMULATED.items():
        if not (folder / name / "frames.json").exists():
            common = "--set image_rate=1 --set images=agc --set scans=0 --truth edges --overwrite --frames"
            subprocess.run([program, "simulate", *scene.split(), *common.split(), str(folder / name)], check=True)
    return sorted(folder.glob("*/*.grey.png"))


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
