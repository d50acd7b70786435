#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Newton iterations per step over step size and over time, one figure per problem.
                                                                          Fang (2022), Figs. 3.9, 3.11, 3.12, 3.13

    iterations.py DIR       reads DIR/study.csv and DIR/iterations.csv, writes DIR/iterations-PROBLEM.png
"""
from drawing import directory, distinct, grid, legend, numbers, plt, read, save, style, where, width

MOST_STEPS = 3  # number of panels over time


def draw(folder, problem, runs, bins):
    schemes = distinct(runs, "integrator")
    steps = distinct(runs, "h")[:MOST_STEPS]
    figure, panels = plt.subplots(1, 1 + len(steps), figsize=(5 + 4.2 * len(steps), 4.8), squeeze=False)
    mean, over_time = panels[0][0], panels[0][1:]
    for scheme in schemes:
        colour, marker = style(scheme, schemes)
        mine = [run for run in where(runs, integrator=scheme) if run["status"] == "ok"]
        mean.semilogx(numbers(mine, "h"), numbers(mine, "iterations_per_step"), "-", marker=marker, color=colour, lw=1.2,
                      ms=6)
        for axes, h in zip(over_time, steps):
            part = where(bins, integrator=scheme, h=h)
            axes.plot(numbers(part, "t"), numbers(part, "mean"), color=colour, lw=width(scheme, schemes))
    mean.set_xlabel("step $h$ [s]")
    mean.set_ylabel("Newton iterations per step, mean over the run")
    mean.set_ylim(bottom=0)
    grid(mean)
    for axes, h in zip(over_time, steps):
        intervals = len(distinct(where(bins, h=h), "t"))
        axes.set_title(f"h = {float(h):g} s, means over {intervals} time intervals", fontsize=9)
        axes.set_xlabel("$t$ [s]")
        axes.set_ylabel("Newton iterations per step")
        axes.set_ylim(bottom=0)
        grid(axes)
    figure.suptitle(f"{problem}: Newton iterations", fontsize=11)
    save(figure, folder, f"iterations-{problem}.png", legend(figure, schemes))


def main():
    folder = directory()
    runs, bins = read(folder, "study.csv"), read(folder, "iterations.csv")
    for problem in distinct(runs, "problem"):
        draw(folder, problem, where(runs, problem=problem), where(bins, problem=problem))


if __name__ == "__main__":
    main()
