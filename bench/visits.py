#!/usr/bin/env python3
"""Second visits to the same place: another way through it, hours later and warmer, with a fault that was not there before (rows A1 to A3
of bench/sequences.yaml; all of it simulated). What `pllit compare` says of the two walks, and whether it refuses the walk through
another building.

    bench/visits.py --rows A1 A2 --first-seed 911 --seeds 2          # 10 K of fault, 15 K warmer
    bench/visits.py --rows A1 A2 --first-seed 911 --seeds 2 --fault 20 --warmer -10

A change counts as the fault within 25 cm of what of it can be seen. Recordings and runs are kept in results/heat, as those of
bench/heat.py are. Needs numpy.
"""

import json
import subprocess
import sys

import numpy as np

import heat
import sequences

NEAR_M = 0.25


def arguments():
    parser = heat.walks_parser(__doc__, ["A1", "A2"])
    parser.add_argument("--fault", type=float, default=10.0, help="how much hotter it is, K")
    parser.add_argument("--warmer", type=float, default=15.0, help="the air on the second visit, K")
    return parser.parse_args()


def visits_of(row, seed, wanted):
    """(bag, session, summary) of the first and of the second walk."""
    later = ["finding_at=0", f"finding_K={wanted.fault:g}", "visit=1", f"warmer_K={wanted.warmer:g}"]
    for name, keys in (("before", ["finding_at=3000"]), (f"after{wanted.fault:+g}K{wanted.warmer:+g}K", later)):
        bag = sequences.recording(row, seed, wanted, name=name, keys=keys)
        yield bag, *heat.walked(row, seed, bag, name, wanted)


def compared(before, after):
    """What `pllit compare` says of a session; nothing where it refuses."""
    done = subprocess.run([sequences.PLLIT, "compare", str(before), str(after), "--json"], capture_output=True, text=True)
    if done.returncode not in (0, 2):
        sys.exit(f"pllit compare failed: {done.stderr}")
    return json.loads(done.stdout)["sessions"][0] if done.returncode == 0 else None


def poses(file):
    return np.loadtxt(file, ndmin=2)


def laid_on(truth, session):
    """(R, t) that lay the true world on the session's: least squares over the positions (Umeyama 1991)."""
    true, own = poses(truth), poses(session / "trajectory.tum")
    at = true[np.searchsorted(true[:, 0], own[:, 0]).clip(0, len(true) - 1), 1:4]
    middle, own_middle = at.mean(0), own[:, 1:4].mean(0)
    u, _, vt = np.linalg.svd((own[:, 1:4] - own_middle).T @ (at - middle))
    R = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return R, own_middle - R @ middle


def registration_error_m(comparison, before, after):
    """How far the comparison puts the second walk from where it was, in the middle of its way."""
    (R_A, t_A), (R_B, t_B) = (laid_on(bag.with_suffix(".tum"), session) for bag, session, _ in (before, after))
    T = comparison["T_baseline_session"]
    middle_B = poses(after[1] / "trajectory.tum")[:, 1:4].mean(0)
    return float(np.linalg.norm(moved(T, middle_B) - (R_A @ (R_B.T @ (middle_B - t_B)) + t_A)))


def moved(pose, point):
    *v, w = pose["rotation_xyzw"]
    return point + 2 * np.cross(v, np.cross(v, point) + w * point) + np.array(pose["translation_m"])


def alarms_of(session):
    return sum(one["state"] != "new" for one in json.loads((session / "anomalies.json").read_text())["anomalies"])


def cells_of(before, after, wanted):
    comparison = compared(before[1], after[1])
    if not comparison:
        return ["refused"] + [""] * 5
    R, t = laid_on(before[0].with_suffix(".tum"), before[1])
    fault = next(thing for thing in json.loads(after[0].with_suffix(".scene.json").read_text())["objects"] if thing["finding"])
    fault_A = R @ np.array(fault["centroid_W"]) + t
    off_m = [float(np.linalg.norm(np.array(change["position_m"]) - fault_A)) for change in comparison["changes"]]
    hit = min((off for off, change in zip(off_m, comparison["changes"]) if change["kind"] in ("hotter", "new_hot")), default=9.0)
    places, seen = comparison["relocalisation"], comparison["voxels"]
    again = seen["shared"] / max(1, seen["shared"] + seen["not_seen_again"])
    others = [change["kind"] for change, off in zip(comparison["changes"], off_m) if off > NEAR_M]
    return [f"{places['agreeing']} of {places['places']}", f"{registration_error_m(comparison, before, after):.3f}", f"{100 * again:.0f}",
            f"{hit:.3f}" if hit < NEAR_M else "missed", ", ".join(others) or "none", str(alarms_of(after[1]))]


def main():
    wanted = arguments()
    wanted.out.mkdir(parents=True, exist_ok=True)
    print("| row (simulated) | seed | places that agree | registered off by m | shown again % | fault, off by m | other changes | alarms of the second walk itself |\n"
          "|---|---|---|---|---|---|---|---|")
    baselines, later = [], []
    for row in sequences.table_rows(wanted):
        for seed in range(wanted.first_seed, wanted.first_seed + wanted.seeds):
            before, after = visits_of(row, seed, wanted)
            cells = cells_of(before, after, wanted) if before[2] and after[2] else ["failed"] + [""] * 5
            print("| " + " | ".join([row["name"], str(seed)] + cells) + " |", flush=True)
            baselines.append(before[1])
            later.append(after[1])
    strangers = list(zip(baselines[1:] + baselines[:1], later)) if len(later) > 1 else []
    refused = sum(compared(before, after) is None for before, after in strangers)
    print(f"\nof {len(strangers)} walks through another building {refused} are refused")


if __name__ == "__main__":
    main()
