#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""CPU time per step of the N-bar pendulum over N, its ratio to rA-full-1, and iterations.   Fang (2022), Fig. 3.15

    scaling.py DIR      reads DIR/study.csv, writes DIR/scaling.png
"""
from drawing import Line2D, axis, by_scheme, directory, distinct, legend, number, numbers, plt, read, save, times_and_ratios


def draw(folder):
    rows = [row for row in read(folder, "study.csv") if row["status"] == "ok"]
    figure, (time, ratio, iterations) = plt.subplots(1, 3, figsize=(10.8, 4.4))
    for _, mine, look in by_scheme(rows):
        times_and_ratios(time, ratio, mine, "bars", ms=5, **look)
        iterations.plot(numbers(mine, "bars"), numbers(mine, "iterations_per_step"), "-", lw=1.2, ms=5, **look)
    N = sorted(set(numbers(rows, "bars")))
    top = max(numbers(rows, "us_per_step"))
    time.plot(N, [2 * top * n / N[-1] for n in N], ":", color="0.6", lw=1, zorder=0)
    time.set_yscale("log")
    time.set_ylabel("thread CPU time per step [µs]")
    ratio.axhline(1, color="0.6", lw=1, zorder=0)
    ratio.set_ylabel("CPU time relative to rA-full-1")
    iterations.set_ylabel("Newton iterations per step, mean")
    for axes in (ratio, iterations):
        axes.set_ylim(bottom=0)
    for axes in (time, ratio, iterations):
        axes.set_xscale("log", base=2)
        axis(axes, "number of bars $N$")
    figure.suptitle(f"N-bar pendulum, h = {number(rows[0]['h']):g} s: CPU time per step, median of the repeats", fontsize=11)
    more = [Line2D([], [], color="0.6", ls=":", label="slope 1")]
    save(figure, folder, "scaling.png", legend(figure, distinct(rows, "integrator"), more=more, columns=6))


draw(directory())
