#!/usr/bin/env python3
"""What each step of the thermal-visual update adds, on rows of the table of sequences (bench/sequences.yaml; all of it simulated).

    bench/ablation.py --rows H18 --duration 60                   # six runs a row and seed: about ten minutes
    bench/ablation.py --rows H04 H16 --seeds 3 --steps lidar full
    bench/ablation.py --rows N1 --duration 160 --plot n1.png     # 1 km; with python3-matplotlib: error over distance

The steps: `lidar` uses no image; `points` adds points of raw images, `photometric` calibrates their greys, `weights` weights points that lie on
lines, `full` adds explicit lines, and `unaligned` is that without aligning points with the image. Loops stay open. Recordings are rendered once and kept with the runs in results/ablation: a second call
runs only what is missing. Errors over 5 m (walks) or 100 m (drives) are compared with those of `lidar`, seed by seed and place by place:
the change of their median, and its 95 % interval by a bootstrap over blocks of that length. Needs Python's standard library alone.
"""

import argparse
import csv
import pathlib
import random
import statistics
import subprocess

import sequences

STEPS = {
    "lidar": ["thermal.enabled=false"],
    "points": ["thermal.photometric=false", "thermal.weights=false", "thermal.lines=false"],
    "photometric": ["thermal.weights=false", "thermal.lines=false"],
    "weights": ["thermal.lines=false"],
    "unaligned": ["advanced.vision.align=false"],
    "full": [],
}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", nargs="+", required=True)
    parser.add_argument("--seeds", type=int, default=1, help="seeds 1 to N of each row")
    parser.add_argument("--steps", nargs="+", choices=STEPS, default=list(STEPS))
    parser.add_argument("--duration", type=float, help="the first so many seconds of each recording")
    parser.add_argument("--out", type=pathlib.Path, default=sequences.ROOT / "results" / "ablation")
    parser.add_argument("--cache-gb", type=float, default=40.0)
    parser.add_argument("--plot", type=pathlib.Path, help="draw the error over the distance, a panel for each row")
    return parser.parse_args()


def delta_of(row):
    return 100.0 if row["name"].startswith("N") else 5.0


def errors_of(truth, session, delta):
    """Rows of `pllit eval --errors`: distance, error and yaw of each pair; and of each pose."""
    file = session / "errors.csv"
    subprocess.run([sequences.PLLIT, "eval", str(truth), str(session / "odometry.tum"), "--rpe", str(delta), "--errors", str(file)],
                   check=True, stdout=subprocess.DEVNULL)
    with file.open() as lines:
        rows = list(csv.DictReader(lines))
    figures = lambda row: tuple(float(row[name]) for name in ("distance_m", "error_m", "yaw_deg"))
    return {measure: [figures(row) for row in rows if row["measure"] == measure] for measure in ("ape", "rpe")}


def run(row, seed, step, wanted):
    """Summary and errors of a run; nothing where it failed."""
    name = f"{row['name']}-{seed}" + (f"-{wanted.duration:g}s" if wanted.duration else "") + f"-{step}"
    bag = sequences.recording(row, seed, wanted, wanted.duration)
    truth, session = bag.with_suffix(".tum"), wanted.out / name
    settings = [part for setting in ["loop.enabled=false"] + STEPS[step] for part in ("--set", setting)]
    summary = sequences.summary_of(session, [str(bag), "--truth", str(truth), "--config", row["config"]] + settings)
    return summary and {"summary": summary, "errors": errors_of(truth, session, delta_of(row))}


def blocks(errors, base, delta, column):
    """Errors of a run and of the base run at the same places, in blocks of `delta` metres of way."""
    found = {}
    for ours, theirs in zip(errors["rpe"], base["rpe"]):
        found.setdefault(int(theirs[0] / delta), []).append((ours[column], theirs[column]))
    return list(found.values())


def gain(pairs):
    ours, theirs = (statistics.median(abs(pair[i]) for pair in pairs) for i in (0, 1))
    return 100.0 * (1.0 - ours / theirs) if theirs > 0.0 else 0.0


def interval(all_blocks):
    """By how many percent the median error is smaller than the base's, and its 95 % interval (paired block bootstrap)."""
    if not all_blocks:
        return None
    choose = random.Random(1)
    draws = sorted(gain([pair for block in choose.choices(all_blocks, k=len(all_blocks)) for pair in block]) for _ in range(500))
    return gain([pair for block in all_blocks for pair in block]), draws[12], draws[487]


def better(found):
    return "-" if found is None else f"{found[0]:+.0f} % ({found[1]:+.0f} to {found[2]:+.0f})"


def print_row(row, step, runs, base):
    good = {seed: found for seed, found in runs.items() if found}
    spread = sequences.spread
    summaries = [found["summary"] for found in good.values()]
    cells = [row["name"], step, f"{len(good)}/{len(runs)}", spread([s["ape"]["rmse"] for s in summaries if s.get("ape")], 3)]
    rpe = [statistics.median(e[1] for e in found["errors"]["rpe"]) for found in good.values() if found["errors"]["rpe"]]
    cells.append(spread(rpe, 4))
    for column in (1, 2):
        shared = [block for seed, found in good.items() if base.get(seed) and step != "lidar"
                  for block in blocks(found["errors"], base[seed]["errors"], delta_of(row), column)]
        cells.append(better(interval(shared)))
    cells.append(spread([s["frame_ms"]["mean"] for s in summaries], 0))
    cells.append(spread([s["frame_ms"]["p99"] for s in summaries], 0))
    print("| " + " | ".join(cells) + " |", flush=True)


def plot(file, table):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    _, panels = plt.subplots(len(table), 1, figsize=(10, 3 * len(table)), squeeze=False)
    for axes, (name, steps) in zip(panels[:, 0], table.items()):
        for step, runs in steps.items():
            first = next((found for found in runs.values() if found), None)
            if first:
                axes.plot(*zip(*((e[0], e[1]) for e in first["errors"]["ape"])), label=step, lw=1)
        axes.set(title=f"{name}, simulated, first seed", xlabel="way, m", ylabel="error after alignment, m", yscale="log")
        axes.legend(loc="upper left", ncols=5, fontsize=8)
    plt.tight_layout()
    plt.savefig(file, dpi=80)


def main():
    wanted = arguments()
    table = {}
    print("| row (simulated) | step | runs | APE rmse m | median RPE m | RPE better by | yaw better by | ms a frame | p99 |\n|---|---|---|---|---|---|---|---|---|")
    wanted.tier = "full"
    for row in sequences.table_rows(wanted):
        steps = table.setdefault(row["name"], {})
        for step in wanted.steps:
            steps[step] = {seed: run(row, seed, step, wanted) for seed in range(1, wanted.seeds + 1)}
            print_row(row, step, steps[step], steps.get("lidar", {}))
    if wanted.plot:
        plot(wanted.plot, table)


if __name__ == "__main__":
    main()
