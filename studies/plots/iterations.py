#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Newton iterations per step over step size and over time, one figure per problem.
                                                                          Fang (2022), Figs. 3.9, 3.11, 3.12, 3.13

    iterations.py DIR       reads DIR/study.csv and DIR/iterations.csv, writes DIR/iterations-PROBLEM.png
"""
from drawing import along, axis, by_scheme, chosen, distinct, for_each, legend, numbers, plt, save, shown, where

MOST_STEPS = 3  # number of panels over time


def from_zero(axes):
    """A vertical axis that begins at 0, with room for the markers of the largest value"""
    axes.set_ylim(0, 1.05 * max((y for line in axes.lines for y in line.get_ydata() if y > 0), default=1))


def draw(folder, problem, runs, bins):
    schemes = shown(distinct(runs, "integrator"))
    names = chosen(["mean", "time"])
    steps = distinct(runs, "h")[:MOST_STEPS] if "time" in names else []
    count = len(steps) + ("mean" in names)
    figure, all_axes = plt.subplots(-(-count // 2), min(2, count), figsize=(5.2 * min(2, count), 1 + 3.4 * -(-count // 2)),
                                    squeeze=False)
    panels = list(all_axes.flat)
    for axes in panels[count:]:
        axes.remove()
    mean, over_time = (panels[0], panels[1:]) if "mean" in names else (None, panels)
    for place, (scheme, mine, look) in enumerate(by_scheme(runs)):
        mine = [run for run in mine if run["status"] == "ok"]
        if mean:
            mean.semilogx(numbers(mine, "h"), numbers(mine, "iterations_per_step"), "-", lw=1.2, ms=6, **look)
        for axes, h in zip(over_time, steps):
            part = where(bins, integrator=scheme, h=h)
            along(axes, numbers(part, "t"), numbers(part, "mean"), place, len(schemes), **look)
    if mean:
        axis(mean, "step $h$ [s]", "Newton iterations per step, mean")
        from_zero(mean)
    for axes, h in zip(over_time, steps):
        intervals = len(distinct(where(bins, h=h), "t"))
        axis(axes, "$t$ [s]", "Newton iterations per step", f"h = {float(h):g} s, means over {intervals} time intervals", 9)
        from_zero(axes)
    figure.suptitle(f"{problem}: Newton iterations", fontsize=11)
    save(figure, folder, f"iterations-{problem}.png", legend(figure, schemes, columns=5))


for_each("problem", draw, "iterations.csv")
