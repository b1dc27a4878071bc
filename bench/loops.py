#!/usr/bin/env python3
"""Loop closing on simulated drives and walks, scored against the truth: recall and precision of revisits, APE before and after.

    bench/loops.py --rows street_07 --seeds 3            # one line of JSON a run in results/loops, a table at the end
    bench/loops.py --rows corridor plant --seeds 10      # places with repetitive structure: every accepted loop must be right

Keyframes of a run are kept in results/loops, so that a second call with other settings (--set) takes seconds. With --plot, python3-matplotlib
draws each run from above. Everything is simulated.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys

import sequences

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = pathlib.Path(os.environ.get("PLLIT_DATA", ROOT.parent / "shared" / "data")) / "trajectories"
ROWS = {  # address without the seed, preset, file of the motion, yaw drifts in degrees a minute
    "street_07": ("sim:street?motion=kitti_07.tum&images=none", "ntu4dradlm", "kitti_07.tum", [0.0, 1.0]),
    "street_07_all_around": ("sim:street?motion=kitti_07.tum&rig=hilti2022&images=none", "hilti2022", "kitti_07.tum", [0.0, 1.0]),
    "street_00": ("sim:street?motion=kitti_00.tum&images=none", "ntu4dradlm", "kitti_00.tum", [0.0, 1.0]),
    "street_7km": ("sim:street?motion=kitti_00.tum&length=7400&images=none", "ntu4dradlm", "kitti_00.tum", [0.0]),
    "corridor": ("sim:corridor?length=120&images=none", "hilti2022", None, [0.0]),
    "plant": ("sim:plant?images=none", "inspection", None, [0.0]),
}


def run(row, seed, drift, wanted):
    address, preset, motion, _ = ROWS[row]
    folder = wanted.out / f"{row}-{seed}-{drift:g}"
    command = [str(ROOT / "build/release/bench/bench_loops"), f"{address}&seed={seed}", preset, "--drift", str(drift),
               "--keep", str(wanted.out / f"{row}-{seed}.keyframes"), "--out", str(folder)]
    if motion:
        command += ["--motion", str(DATA / motion)]
    for setting in wanted.set:
        command += ["--set", setting]
    done = subprocess.run(sequences.in_environment(command), capture_output=True, text=True)
    if done.returncode != 0:
        print(f"{row} seed {seed}: {done.stderr[-2000:]}", file=sys.stderr)
        return None
    (folder / "summary.json").write_text(done.stdout)
    if wanted.plot:
        plot(folder)
    return json.loads(done.stdout)


def plot(folder):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    _, axes = plt.subplots(figsize=(11, 9))
    for name, style in (("truth", "k-"), ("odometry", "b-"), ("trajectory", "r-")):
        path = np.loadtxt(folder / f"{name}.tum")
        if name == "truth":
            truth = path
        else:  # first poses and first headings brought together
            n = min(len(path), 30)
            turn = np.arctan2(*(truth[n - 1, 2:0:-1] - truth[0, 2:0:-1])) - np.arctan2(*(path[n - 1, 2:0:-1] - path[0, 2:0:-1]))
            c, s = np.cos(turn), np.sin(turn)
            path[:, 1:3] = (path[:, 1:3] - path[0, 1:3]) @ np.array([[c, s], [-s, c]]) + truth[0, 1:3]
        axes.plot(path[:, 1], path[:, 2], style, lw=1, label=name)
    axes.set(aspect="equal", xlabel="x, m", ylabel="y, m", title=folder.name)
    axes.legend()
    plt.savefig(folder / "plot.png", dpi=90)
    plt.close()


def spread(values, form):
    if not values:
        return "-"
    return format(statistics.mean(values), form) + (f" ({min(values):{form}} to {max(values):{form}})" if len(values) > 1 else "")


def print_row(row, drift, results):
    recall = {kind: [r["revisits"][kind]["recall"] for r in results if r["revisits"][kind]["recall"] is not None] for kind in ("same_way", "reverse")}
    print(f"| {row} | {drift:g} | {spread([r['length_m'] for r in results], '.0f')} | {spread(recall['same_way'], '.2f')} | {spread(recall['reverse'], '.2f')} "
          f"| {sum(r['accepted'] for r in results)} | {sum(r['wrong'] for r in results)} | {spread([r['ape_before_m'] for r in results], '.2f')} "
          f"| {spread([r['ape_after_m'] for r in results], '.2f')} | {spread([r['keyframe_ms']['mean'] for r in results], '.1f')} "
          f"| {spread([r['mb_per_km'] for r in results], '.1f')} | {len(results)} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", nargs="+", choices=list(ROWS), default=["street_07"])
    parser.add_argument("--seeds", type=int, default=3, help="seeds 1 to N of each row")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results" / "loops")
    parser.add_argument("--set", nargs="*", default=[], help="settings of the configuration")
    parser.add_argument("--plot", action="store_true")
    wanted = parser.parse_args()
    wanted.out.mkdir(parents=True, exist_ok=True)
    print("| row (simulated) | yaw drift, deg/min | length m | recall, same way | recall, reverse | loops | of them wrong | APE before m | APE after m "
          "| ms a keyframe | MB/km | runs |\n|---|---|---|---|---|---|---|---|---|---|---|---|")
    for row in wanted.rows:
        for drift in ROWS[row][3]:
            results = [run(row, seed, drift, wanted) for seed in range(wanted.first_seed, wanted.first_seed + wanted.seeds)]
            print_row(row, drift, [r for r in results if r])


if __name__ == "__main__":
    main()
