#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Work-precision diagrams: error over CPU time, one figure per problem.

    work-precision.py DIR       reads DIR/study.csv, writes DIR/work-precision-PROBLEM.png
"""
from drawing import axis, by_scheme, distinct, for_each, legend, number, numbers, plt, save

PANELS = [("r", "position $r$, rms [m]"), ("v", "velocity $\\dot r$, rms [m/s]"), ("Q", "constraint loads, rms, relative")]


def draw(folder, problem, rows):
    figure, panels = plt.subplots(1, 3, figsize=(15.5, 5.4), sharex=True)
    for (norm, title), axes in zip(PANELS, panels):
        for _, mine, look in by_scheme(rows):
            mine = [row for row in mine if row["status"] == "ok" and number(row[norm]) > 0]
            axes.loglog([1e3 * t for t in numbers(mine, "cpu_seconds")], numbers(mine, norm), "-", lw=1.2, ms=5, **look)
        axis(axes, "thread CPU time of the run [ms]", title=title)
    panels[0].axhline(1e-3, color="0.6", lw=1, ls="--", zorder=0)
    panels[0].set_ylabel("error (units in the panel titles)")
    figure.suptitle(f"{problem}, end time {number(rows[0]['end']):g} s: error over CPU time; reference: {rows[0]['reference']}",
                    fontsize=11)
    save(figure, folder, f"work-precision-{problem}.png", legend(figure, distinct(rows, "integrator")))


for_each("problem", draw)
