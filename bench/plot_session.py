#!/usr/bin/env python3
"""Draws a session from above: plot_session.py SESSION OUT.png [Z_LOW Z_HIGH] (needs python3-matplotlib)."""
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np


def read_ply(path):
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode().split("\n")
    count = int(next(line for line in header if line.startswith("element vertex")).split()[2])
    fields = [line.split()[2] for line in header if line.startswith("property")]
    return np.frombuffer(data, np.float32, count * len(fields), end).reshape(count, len(fields))


def main():
    session, out = Path(sys.argv[1]), sys.argv[2]
    low, high = (float(v) for v in sys.argv[3:5]) if len(sys.argv) > 4 else (-1.0, 1.5)
    points = read_ply(session / "map.ply")
    points = points[(points[:, 2] > low) & (points[:, 2] < high)]
    path = np.loadtxt(session / "trajectory.tum")
    centre, reach = path[:, 1:3].mean(0), np.ptp(path[:, 1:3], axis=0).max() / 2 + 20
    _, axes = plt.subplots(figsize=(12, 9))
    axes.scatter(points[:, 0], points[:, 1], s=0.2, c=points[:, 2], cmap="viridis", lw=0)
    axes.plot(path[:, 1], path[:, 2], "r", lw=1.2)
    axes.set(aspect="equal", xlabel="x, m", ylabel="y, m")
    axes.set_xlim(max(centre[0] - reach, points[:, 0].min()), min(centre[0] + reach, points[:, 0].max()))
    axes.set_ylim(max(centre[1] - reach, points[:, 1].min()), min(centre[1] + reach, points[:, 1].max()))
    plt.tight_layout()
    plt.savefig(out, dpi=100)


main()
