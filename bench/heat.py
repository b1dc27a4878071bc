#!/usr/bin/env python3
"""Inspection walks with hot objects in them (rows A1 to A3 of bench/sequences.yaml; all of it simulated): what is found, where, how soon,
and how often something is reported that is none.

    bench/heat.py --rows A1 A2 A3 --seeds 10                    # seeds 1 to 10 of each row
    bench/heat.py --rows A2 --first-seed 31 --seeds 1 --pictures # with bench_finding_pictures: what images show of every alarm
    bench/heat.py --rows A1 A2 A3 --video                        # the video after gain control instead of raw counts
    bench/heat.py --rows A1 --name calm -- --set advanced.anomalies.min_change=45

Recordings are rendered once and kept up to --cache-gb in results/heat; runs that exist are not run again, so that a call that was
interrupted goes on where it stopped. Loops stay open. The rate of false alarms comes with the upper end of its 95 % interval, for
alarms that come by chance (Poisson). Needs nothing but Python's standard library.
"""

import argparse
import concurrent.futures
import json
import math
import pathlib
import statistics
import subprocess

import sequences

PICTURES = sequences.ROOT / "build/release/bench/bench_finding_pictures"


def walks_parser(description, rows):
    """What every benchmark on walks is told."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", nargs="+", default=rows)
    parser.add_argument("--seeds", type=int, default=1, help="so many seeds of each row ...")
    parser.add_argument("--first-seed", type=int, default=1, help="... from this one on")
    parser.add_argument("--name", default="", help="keeps these runs apart from those with other settings")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--pictures", action="store_true", help="draw each alarm and what was missed into the sessions")
    parser.add_argument("--out", type=pathlib.Path, default=sequences.ROOT / "results" / "heat")
    parser.add_argument("--cache-gb", type=float, default=30.0)
    parser.add_argument("more", nargs="*", help="after --: further arguments of `pllit run`")
    return parser


def arguments():
    parser = walks_parser(__doc__, ["A1", "A2", "A3"])
    parser.add_argument("--video", action="store_true", help="8-bit video after gain control instead of raw counts")
    return parser.parse_args()


def scored_walks(rows, wanted):
    """(row, seed, scores) of each walk, in order, as they are done; scores are None where the run failed."""
    walks = [(row, seed) for row in rows for seed in range(wanted.first_seed, wanted.first_seed + wanted.seeds)]
    with concurrent.futures.ThreadPoolExecutor(wanted.jobs) as jobs:
        for (row, seed), found in zip(walks, jobs.map(lambda walk: findings_of(*walk, wanted), walks)):
            yield row, seed, found


def walked(row, seed, bag, kind, wanted):
    """The session of a walk and its summary; nothing for the latter where the run failed."""
    session = wanted.out / "-".join(filter(None, [row["name"], str(seed), kind, wanted.name]))
    source = [str(bag), "--truth", str(bag.with_suffix(".tum")), "--config", row["config"], "--set", "loop.enabled=false"]
    return session, sequences.summary_of(session, source + wanted.more)


def findings_of(row, seed, wanted):
    """What `pllit eval --findings` says of a walk, its scene, and how long it was watched; nothing where the run failed."""
    bag = sequences.recording(row, seed, wanted, **({"name": "agc", "keys": ["images=agc"]} if wanted.video else {}))
    session, summary = walked(row, seed, bag, "video" if wanted.video else "", wanted)
    scene = bag.with_suffix(".scene.json")
    if not summary:
        return None
    scored = subprocess.run([sequences.PLLIT, "eval", "--findings", str(scene), str(session), "--json"], check=True, capture_output=True, text=True)
    if wanted.pictures:
        subprocess.run(sequences.in_environment([str(PICTURES), str(bag), str(session), row["config"], "--scene", str(scene)]), check=True)
    return json.loads(scored.stdout)["findings"] | {"scene": json.loads(scene.read_text()), "watched_s": summary["duration_s"]}


def poisson_bound(count):
    """The rate of which no more than `count` come in one case of twenty."""
    low, high = float(count), count + 10.0 + 5.0 * math.sqrt(count + 1.0)
    for _ in range(60):
        rate = 0.5 * (low + high)
        below = sum(math.exp(k * math.log(rate) - rate - math.lgamma(k + 1)) for k in range(count + 1))
        low, high = (rate, high) if below > 0.05 else (low, rate)
    return high


def cells_of(found):
    position, delay = found["position_m"]["max"], found["delay_s"]["max"]
    shown = lambda value, form: "" if value is None else format(value, form)
    return [f"{found['found']} of {found['objects']}", str(found["false_alarms"]), str(found["duplicates"]), shown(position, ".3f"), shown(delay, ".1f"),
            f"{found['watched_s']:.0f}"]


def print_total(results):
    minutes = sum(r["watched_s"] for r in results) / 60.0
    false_alarms = sum(r["false_alarms"] for r in results)
    positions = [r["position_m"]["max"] for r in results if r["position_m"]["max"] is not None]
    delays = [r["delay_s"]["max"] for r in results if r["delay_s"]["max"] is not None]
    print(f"\n{sum(r['found'] for r in results)} of {sum(r['objects'] for r in results)} found", end="")
    if positions:
        print(f", {statistics.median(positions):.3f} m off in the median and {max(positions):.3f} m at most, {sum(d <= 1.0 for d in delays)} within a second", end="")
    print(f"; {false_alarms} false alarms in {minutes:.1f} minutes, at most {poisson_bound(false_alarms) / minutes:.2f} a minute (95 %)")


def main():
    wanted = arguments()
    wanted.out.mkdir(parents=True, exist_ok=True)
    print("| row (simulated) | seed | found | false alarms | duplicates | position off by m | alarm after s | watched s |\n|---|---|---|---|---|---|---|---|")
    results = []
    for row, seed, found in scored_walks(sequences.table_rows(wanted), wanted):
        print("| " + " | ".join([row["name"], str(seed)] + (cells_of(found) if found else ["failed"] + [""] * 5)) + " |", flush=True)
        results += [found] if found else []
    if results:
        print_total(results)


if __name__ == "__main__":
    main()
