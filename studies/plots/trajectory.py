#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Positions, angular velocities, energy and constraint norm of one run.

    trajectory.py DIR       reads DIR/trajectory.csv, writes DIR/trajectory.png
"""
import csv
import math
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6bb1"]
DASHES = {"x": "-", "y": "--", "z": ":"}
MOST_BODIES = 8  # of longer chains, equally spaced bodies are drawn


def read(path):
    """The columns of a CSV file, by name"""
    with open(path, newline="", encoding="utf-8") as file:
        rows = csv.reader(file)
        names = next(rows)
        columns = {name: [] for name in names}
        for row in rows:
            for name, value in zip(names, row):
                columns[name].append(float(value))
    return columns


def bodies_of(columns):
    names = [name[:-3] for name in columns if name.endswith(".rx")]
    stride = math.ceil(len(names) / MOST_BODIES) or 1
    return names[stride - 1 :: stride]


def components(axes, columns, bodies, symbol, label):
    for colour, body in zip(COLOURS, bodies):
        for axis, dash in DASHES.items():
            axes.plot(columns["t"], columns[f"{body}.{symbol}{axis}"], dash, color=colour, linewidth=1)
    axes.set_ylabel(label)


def main(directory):
    columns = read(os.path.join(directory, "trajectory.csv"))
    bodies = bodies_of(columns)
    figure, axes = plt.subplots(2, 2, figsize=(10, 6.5), sharex=True, constrained_layout=True)

    components(axes[0][0], columns, bodies, "r", "position $r$ [m]")
    components(axes[0][1], columns, bodies, "w", "angular velocity $\\bar\\omega$ [rad/s]")

    energy = columns["energy"]
    axes[1][0].plot(columns["t"], [e - energy[0] for e in energy], color="black", linewidth=1)
    axes[1][0].set_ylabel(f"energy $E - E_0$ [J],  $E_0$ = {energy[0]:.6g} J")
    axes[1][1].plot(columns["t"], [max(c, 1e-17) for c in columns["constraint_norm"]], color="black", linewidth=1)
    axes[1][1].set_yscale("log")
    axes[1][1].set_ylabel("largest constraint residual [m or rad]")

    for row in axes:
        for panel in row:
            panel.grid(color="0.9", linewidth=0.6)
            panel.set_axisbelow(True)
    for panel in axes[1]:
        panel.set_xlabel("$t$ [s]")
    handles = [Line2D([], [], color=c, label=b) for c, b in zip(COLOURS, bodies)]
    handles += [Line2D([], [], color="0.4", linestyle=d, label=a) for a, d in DASHES.items()]
    figure.legend(handles=handles, loc="upper center", ncol=min(len(handles), 6),
                  fontsize=8, frameon=False, bbox_to_anchor=(0.5, 1.06))
    figure.savefig(os.path.join(directory, "trajectory.png"), dpi=150, bbox_inches="tight")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
