#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""CPU time per step of the N-bar pendulum over N, its ratio to rA-full-1, and iterations.   Fang (2022), Fig. 3.15

    scaling.py DIR      reads DIR/study.csv, writes DIR/scaling.png
"""
from drawing import Line2D, bars, directory, distinct, grid, legend, number, numbers, plt, read, save, style, where


def main():
    folder = directory()
    rows = [row for row in read(folder, "study.csv") if row["status"] == "ok"]
    schemes = distinct(rows, "integrator")
    figure, (time, ratio, iterations) = plt.subplots(1, 3, figsize=(14.5, 4.9))
    for scheme in schemes:
        colour, marker = style(scheme, schemes)
        mine = where(rows, integrator=scheme)
        N, us = numbers(mine, "bars"), numbers(mine, "us_per_step")
        time.errorbar(N, us, yerr=bars(mine, "us_per_step"), fmt="-", marker=marker, color=colour, lw=1.2, ms=5, capsize=2, elinewidth=0.8)
        ratio.plot(N, numbers(mine, "ratio_to_full"), "-", marker=marker, color=colour, lw=1.2, ms=5)
        iterations.plot(N, numbers(mine, "iterations_per_step"), "-", marker=marker, color=colour, lw=1.2, ms=5)
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
        axes.set_xlabel("number of bars $N$")
        grid(axes)
    figure.suptitle(f"N-bar pendulum, h = {number(rows[0]['h']):g} s: CPU time per step, median of the repeats", fontsize=11)
    more = [Line2D([], [], color="0.6", ls=":", label="slope 1")]
    save(figure, folder, "scaling.png", legend(figure, schemes, more=more))


if __name__ == "__main__":
    main()
