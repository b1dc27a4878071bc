#!/usr/bin/env python3
"""How well hot boxes are found, against how hot, how large and how near they are (rows S1 and S2 of bench/sequences.yaml: ten boxes a
walk, 5 to 40 K warmer, 10 to 50 cm large, heated where they stand or brought in hot; all of it simulated).

    bench/heat_sweep.py --seeds 10 --plot docs/heat_sweep.png           # ten walks of each row, raw counts
    bench/heat_sweep.py --seeds 10 --video --plot docs/heat_sweep.png   # and the video after gain control beside them

Only boxes that an image showed within 10 m after they began count; "near" is the nearest that the camera then came to each. Walks and
runs are kept in results/heat, as those of bench/heat.py are. The plot needs matplotlib, the table nothing but Python's standard library.
"""

import pathlib
import statistics

import heat
import sequences

BINS = {  # of what, in what unit, edges
    "by_K": ("warmer by, K", [5, 10, 15, 20, 30, 40]),
    "size_m": ("edge, m", [0.1, 0.2, 0.3, 0.4, 0.5]),
    "nearest_m": ("nearest, m", [0, 2, 3, 4, 6, 10]),
}


def arguments():
    parser = heat.walks_parser(__doc__, ["S1", "S2"])
    parser.set_defaults(seeds=10)
    parser.add_argument("--video", action="store_true", help="also the 8-bit video after gain control")
    parser.add_argument("--plot", type=pathlib.Path, help="draw recall into this PNG")
    return parser.parse_args()


def boxes_of(scores):
    """Every box of a walk that was to be seen, with what became of it."""
    scene = {thing["name"]: thing for thing in scores["scene"]["objects"]}
    return [scene[one["name"]] | one for one in scores["each"]]


def recall(boxes, key):
    """(from, to, found, boxes) of each bin that holds any."""
    edges = BINS[key][1]
    for low, high in zip(edges, edges[1:]):
        held = [box for box in boxes if box[key] is not None and low <= box[key] < high]
        if held:
            yield low, high, sum(box["found"] for box in held), len(held)


def print_sweep(name, boxes, scores):
    found = [box for box in boxes if box["found"]]
    minutes = sum(score["watched_s"] for score in scores) / 60.0
    print(f"\n{name}: {len(found)} of {len(boxes)} boxes found in {len(scores)} walks of {minutes:.0f} minutes in all, "
          f"{sum(score['false_alarms'] for score in scores)} false alarms", end="")
    if found:
        print(f"; {statistics.median(box['position_m'] for box in found):.3f} m off in the median", end="")
    print("\n\n| " + name + " | from | to | found | of |\n|---|---|---|---|---|")
    for key, (label, _) in BINS.items():
        for low, high, hits, count in recall(boxes, key):
            print(f"| {label} | {low:g} | {high:g} | {hits} | {count} |")


def draw(inputs, file):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, len(BINS), figsize=(4 * len(BINS), 3.2), sharey=True)
    for axis, (key, (label, _)) in zip(axes, BINS.items()):
        for name, boxes in inputs.items():
            bins = list(recall(boxes, key))
            middles, shares = [0.5 * (b[0] + b[1]) for b in bins], [b[2] / b[3] for b in bins]
            axis.plot(middles, shares, "o-", label=name)
            for x, y, (_, _, _, count) in zip(middles, shares, bins):
                axis.annotate(f"{count}", (x, y), textcoords="offset points", xytext=(0, 5), ha="center", fontsize=7)
        axis.set(xlabel=label, ylim=(-0.05, 1.12))
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("recall (simulated)")
    axes[0].legend()
    figure.tight_layout()
    figure.savefig(file, dpi=110)


def main():
    wanted = arguments()
    wanted.out.mkdir(parents=True, exist_ok=True)
    rows = sequences.table_rows(wanted)
    inputs = {}
    for video in (False, True) if wanted.video else (False,):
        wanted.video = video
        name = "video" if video else "raw counts"
        scores = [found for _, _, found in heat.scored_walks(rows, wanted) if found]
        inputs[name] = [box for walk in scores for box in boxes_of(walk)]
        print_sweep(name, inputs[name], scores)
    if wanted.plot:
        draw(inputs, wanted.plot)


if __name__ == "__main__":
    main()
