#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Work-precision diagrams: error over CPU time, one figure per problem.

    work-precision.py DIR       reads DIR/study.csv, writes DIR/work-precision-PROBLEM.png
"""
from drawing import distinct, for_each_problem, grid, legend, number, numbers, plt, save, style, where

PANELS = [("r", "position $r$, rms [m]"), ("v", "velocity $\\dot r$, rms [m/s]"), ("Q", "constraint loads, rms, relative")]


def draw(folder, problem, rows):
    schemes = distinct(rows, "integrator")
    figure, panels = plt.subplots(1, 3, figsize=(15.5, 5.4), sharex=True)
    for (norm, title), axes in zip(PANELS, panels):
        for scheme in schemes:
            colour, marker = style(scheme, schemes)
            mine = [row for row in where(rows, integrator=scheme) if row["status"] == "ok" and number(row[norm]) > 0]
            axes.loglog([1e3 * t for t in numbers(mine, "cpu_seconds")], numbers(mine, norm), "-", marker=marker,
                        color=colour, lw=1.2, ms=5)
        axes.set_xlabel("thread CPU time of the run [ms]")
        axes.set_title(title, fontsize=10)
        grid(axes)
    panels[0].axhline(1e-3, color="0.6", lw=1, ls="--", zorder=0)
    panels[0].set_ylabel("error (units in the panel titles)")
    figure.suptitle(f"{problem}, end time {number(rows[0]['end']):g} s: error over CPU time; reference: {rows[0]['reference']}",
                    fontsize=11)
    save(figure, folder, f"work-precision-{problem}.png", legend(figure, schemes))


if __name__ == "__main__":
    for_each_problem(draw)
