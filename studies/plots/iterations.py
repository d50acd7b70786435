#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Newton iterations per step over step size and over time, one figure per problem.
                                                                          Fang (2022), Figs. 3.9, 3.11, 3.12, 3.13

    iterations.py DIR       reads DIR/study.csv and DIR/iterations.csv, writes DIR/iterations-PROBLEM.png
"""
from drawing import axis, by_scheme, distinct, for_each, legend, numbers, plt, save, where, width

MOST_STEPS = 3  # number of panels over time


def draw(folder, problem, runs, bins):
    schemes = distinct(runs, "integrator")
    steps = distinct(runs, "h")[:MOST_STEPS]
    figure, panels = plt.subplots(1, 1 + len(steps), figsize=(5 + 4.2 * len(steps), 4.8), squeeze=False)
    mean, over_time = panels[0][0], panels[0][1:]
    for scheme, mine, look in by_scheme(runs):
        mine = [run for run in mine if run["status"] == "ok"]
        mean.semilogx(numbers(mine, "h"), numbers(mine, "iterations_per_step"), "-", lw=1.2, ms=6, **look)
        for axes, h in zip(over_time, steps):
            part = where(bins, integrator=scheme, h=h)
            axes.plot(numbers(part, "t"), numbers(part, "mean"), color=look["color"], lw=width(scheme, schemes))
    axis(mean, "step $h$ [s]", "Newton iterations per step, mean over the run")
    mean.set_ylim(bottom=0)
    for axes, h in zip(over_time, steps):
        intervals = len(distinct(where(bins, h=h), "t"))
        axis(axes, "$t$ [s]", "Newton iterations per step", f"h = {float(h):g} s, means over {intervals} time intervals", 9)
        axes.set_ylim(bottom=0)
    figure.suptitle(f"{problem}: Newton iterations", fontsize=11)
    save(figure, folder, f"iterations-{problem}.png", legend(figure, schemes))


for_each("problem", draw, "iterations.csv")
