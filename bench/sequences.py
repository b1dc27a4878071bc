#!/usr/bin/env python3
"""Runs the table of sequences (bench/sequences.yaml) and prints the table of errors. All rows are simulated.

    bench/sequences.py --tier smoke --seeds 1            # smoke: about 10 minutes; short: an hour; full: five hours
    bench/sequences.py --rows H04 H05 --seeds 3 -- --set map.voxel_m=0.2

What has run is not run again: results lie in results/sequences, one session a row and seed. With --images the recordings are
rendered to bags first and kept up to --cache-gb, the least recently used ones going first; without, LiDAR and IMU come straight
from the simulator. Needs nothing but Python's standard library.
"""

import argparse
import json
import pathlib
import shutil
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PLLIT = str(ROOT / "pllit")
TIERS = ["smoke", "short", "full"]
COMPRESSED = {"ntu4dradlm"}  # presets that name a compressed topic


def in_environment(command):
    """A command of the build, so that it runs wherever this script does (setup/environment.sh)."""
    return ["bash", "-c", '. "$0"; in_environment "$@"', str(ROOT / "setup" / "environment.sh")] + command


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tier", choices=TIERS, default="smoke", help="a tier holds the ones before it")
    parser.add_argument("--rows", nargs="+", help="these rows instead of a tier")
    parser.add_argument("--seeds", type=int, default=1, help="seeds 1 to N of each row")
    parser.add_argument("--images", action="store_true", help="render images too, into cached bags")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results" / "sequences")
    parser.add_argument("--cache-gb", type=float, default=40.0)
    parser.add_argument("more", nargs="*", help="after --: further arguments of `pllit run`")
    return parser.parse_args()


def table_rows(wanted):
    listed = subprocess.run([PLLIT, "simulate", "--list", "--json"], check=True, capture_output=True, text=True)
    rows = json.loads(listed.stdout)["rows"]
    if wanted.rows:
        unknown = set(wanted.rows) - {row["name"] for row in rows}
        if unknown:
            sys.exit(f"no such row: {', '.join(sorted(unknown))}; there are {', '.join(row['name'] for row in rows)}")
        return [row for row in rows if row["name"] in wanted.rows]
    return [row for row in rows if TIERS.index(row["tier"]) <= TIERS.index(wanted.tier)]


def keep_within(folder, limit_bytes):
    bags = sorted(folder.glob("*.bag"), key=lambda bag: bag.stat().st_atime)
    used = sum(bag.stat().st_size for bag in bags)
    for bag in bags[:-1]:
        if used <= limit_bytes:
            return
        used -= bag.stat().st_size
        bag.unlink()


def recording(row, seed, wanted, duration=None, name="", keys=()):
    """The bag of a row and seed, whole or its first seconds, rendered where the cache has none; with other keys of the simulation it has a
    name of its own."""
    folder = wanted.out / "recordings"
    folder.mkdir(parents=True, exist_ok=True)
    bag = folder / (f"{row['name']}-{seed}" + (f"-{duration:g}s" if duration else "") + (f"-{name}" if name else "") + ".bag")
    if not bag.exists() or not bag.with_suffix(".scene.json").exists():
        part = bag.with_name("unfinished-" + bag.name)
        command = [PLLIT, "simulate", row["name"], "--seed", str(seed), "--overwrite", "--out", str(part)]
        command += ["--jpeg", "95"] if row["config"] in COMPRESSED else []
        command += ["--duration", str(duration)] if duration else []
        command += [word for key in keys for word in ("--set", key)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        for file in folder.glob(part.stem + ".*"):
            file.rename(file.with_name(file.name.removeprefix("unfinished-")))
        keep_within(folder, wanted.cache_gb * 1e9)
    return bag


def summary_of(session, arguments):
    """The summary of `pllit run` with these arguments: an earlier run's, or a new one's. Nothing where it failed."""
    summary = session / "summary.json"
    if summary.exists():
        return json.loads(summary.read_text())
    shutil.rmtree(session, ignore_errors=True)
    done = subprocess.run([PLLIT, "run"] + arguments + ["--json", "--out", str(session)], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        print(f"{session.name}: exit code {done.returncode}\n{done.stderr[-2000:]}", file=sys.stderr)
        return None
    summary.write_text(done.stdout)
    return json.loads(done.stdout)


def run(row, seed, wanted):
    """The summary of a row and seed; nothing where the run failed."""
    if wanted.images:
        bag = recording(row, seed, wanted)
        source = [str(bag), "--truth", str(bag.with_suffix(".tum"))]
    else:
        source = [f"sim:{row['name']}?seed={seed}"]
    return summary_of(wanted.out / f"{row['name']}-{seed}", source + ["--config", row["config"]] + wanted.more)


def spread(values, digits):
    if not values:
        return "-"
    mean = f"{statistics.mean(values):.{digits}f}"
    return mean if len(values) == 1 else f"{mean} ({min(values):.{digits}f}-{max(values):.{digits}f})"


def print_row(row, summaries):
    good = [s for s in summaries if s and s.get("ape")]
    ape = [s["ape"]["rmse"] for s in good]
    share = [100.0 * s["ape"]["rmse"] / s["length_m"] for s in good]
    rpe = [r["percent"] for s in good for r in s["rpe"] if r["delta_m"] == 100.0 and r["percent"] is not None]
    health = [100.0 * s["health"]["good"] / max(1, s["frames"]) for s in good]
    time = [s["frame_ms"]["mean"] for s in good]
    print(f"| {row['name']} | {spread([s['length_m'] for s in good], 0)} | {spread(ape, 3)} | {spread(share, 2)} | {spread(rpe, 2)} "
          f"| {spread(health, 0)} | {spread(time, 1)} | {len(good)}/{len(summaries)} |", flush=True)


def main():
    wanted = arguments()
    print("| row (simulated) | length m | APE rmse m | APE % of length | RPE 100 m % | good % | ms a frame | runs |\n|---|---|---|---|---|---|---|---|")
    for row in table_rows(wanted):
        print_row(row, [run(row, seed, wanted) for seed in range(1, wanted.seeds + 1)])


if __name__ == "__main__":
    main()
