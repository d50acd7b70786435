#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors and Newton iterations over the tolerance of Newton's method, one figure per problem.   Fang (2022), Sec. 3.8.2

    tolerance.py DIR       reads DIR/study.csv, writes DIR/tolerance-PROBLEM.png
"""
from drawing import axis, by_scheme, chosen, distinct, for_each, legend, numbers, plt, save, shown

PANELS = {"r": "rms error of $r$ [m]", "v": "rms error of $\\dot r$ [m/s]", "Q": "rms error of the constraint loads",
          "iterations_per_step": "Newton iterations per step"}


def draw(folder, problem, runs):
    schemes = shown(distinct(runs, "integrator"))
    names = chosen(list(PANELS))
    figure, all_axes = plt.subplots(-(-len(names) // 2), min(2, len(names)), squeeze=False,
                                    figsize=(5.2 * min(2, len(names)), 1 + 3.2 * -(-len(names) // 2)))
    panels = list(all_axes.flat)
    for axes in panels[len(names):]:
        axes.remove()
    for axes, name in zip(panels, names):
        for scheme, mine, look in by_scheme(runs):
            mine = [run for run in mine if run["status"] == "ok"]
            draw_line = axes.semilogx if name == "iterations_per_step" else axes.loglog
            draw_line(numbers(mine, "tolerance"), numbers(mine, name), "-", lw=1.2, ms=5, **look)
        axes.invert_xaxis()
        if name == "iterations_per_step":
            axes.set_ylim(bottom=0)
        axis(axes, "Newton tolerance", PANELS[name])
    figure.suptitle(f"{problem}: h = {float(runs[0]['h']):g} s", fontsize=11)
    save(figure, folder, f"tolerance-{problem}.png", legend(figure, schemes, columns=4))


for_each("problem", draw)
