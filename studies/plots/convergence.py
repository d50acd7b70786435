#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against step, one figure for each problem in study.csv.   Fang (2022), Figs. 3.4, 3.6, 3.7, 3.8

    convergence.py DIR      reads DIR/study.csv, writes DIR/convergence-PROBLEM.png
"""
import csv
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

PANELS = [
    [("r", "position $r$ [m]"), ("A", "orientation $\\|A\\|_F$"), ("v", "velocity $\\dot r$ [m/s]"),
     ("omega", "angular velocity $\\bar\\omega$ [rad/s]"), ("Q", "joint loads, relative")],
    [("r_end", "position [m]"), ("A_end", "orientation"), ("v_end", "velocity [m/s]"),
     ("omega_end", "angular velocity [rad/s]"), ("watched", "")],
]
MARKERS = "osD^vP*X"
# dark to light, told apart by people who do not see red and green
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6bb1"]


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def unit_of(component):
    return {"r": "m", "v": "m/s", "w": "rad/s"}[component[0]]


def slopes(axes, points):
    """Thin lines of slope 1 and 2 from above the largest error."""
    h = sorted({p[0] for p in points})
    if len(h) < 2:
        return
    top = max(p[1] for p in points)
    for slope, style in ((1, ":"), (2, "--")):
        at_end = 1.8 * top
        axes.plot([h[0], h[-1]], [at_end * (h[0] / h[-1]) ** slope, at_end], style, color="0.6", lw=1, zorder=0)


def draw(directory, problem, rows):
    schemes = list(dict.fromkeys(row["integrator"] for row in rows))
    figure, grid = plt.subplots(2, 5, figsize=(18, 7.6), sharex=True)
    watched = rows[0]["watched_scalar"]
    body, component = watched.rsplit(".", 1)
    for panels, line in zip(PANELS, grid):
        for (norm, title), axes in zip(panels, line):
            points = []
            for k, scheme in enumerate(schemes):
                mine = [row for row in rows if row["integrator"] == scheme and row[norm] not in ("", "0")]
                h = [float(row["h"]) for row in mine]
                e = [float(row[norm]) for row in mine]
                points += [(x, y) for x, y, row in zip(h, e, mine) if row["floor_" + norm] != "1"]
                colour = COLOURS[k % len(COLOURS)]
                axes.loglog(h, e, "-", color=colour, lw=1.4)
                for hollow in (False, True):
                    chosen = [n for n, row in enumerate(mine) if (row["floor_" + norm] == "1") == hollow]
                    axes.loglog([h[n] for n in chosen], [e[n] for n in chosen], MARKERS[k % len(MARKERS)], color=colour,
                                mfc="white" if hollow else colour, ms=6)
            if points:
                slopes(axes, points)
            axes.set_title(title or f"${component[0]}_{component[1]}$ of {body} [{unit_of(component)}], norm of Fig. 3.4",
                           fontsize=10)
            axes.grid(True, which="major", color="0.92")
    grid[0][0].set_ylabel("error, rms over the instants")
    grid[1][0].set_ylabel(f"error at the end, {body}")
    for axes in grid[1]:
        axes.set_xlabel("step $h$ [s]")
    handles = [Line2D([], [], color=COLOURS[k % len(COLOURS)], marker=MARKERS[k % len(MARKERS)], label=scheme)
               for k, scheme in enumerate(schemes)]
    handles += [Line2D([], [], color="0.6", ls=":", label="slope 1"), Line2D([], [], color="0.6", ls="--", label="slope 2"),
                Line2D([], [], color="0.3", marker="o", mfc="white", ls="", label="at rounding or Newton tolerance")]
    figure.legend(handles=handles, loc="lower center", ncol=len(handles), frameon=False)
    figure.suptitle(f"{problem}: error against step size")
    figure.tight_layout(rect=(0, 0.05, 1, 0.98))
    path = os.path.join(directory, f"convergence-{problem}.png")
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return path


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: convergence.py DIR")
    directory = sys.argv[1]
    rows = read(os.path.join(directory, "study.csv"))
    for problem in dict.fromkeys(row["problem"] for row in rows):
        draw(directory, problem, [row for row in rows if row["problem"] == problem])


if __name__ == "__main__":
    main()
