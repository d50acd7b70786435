#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""CPU time per step over step size, by problem and scheme, and its ratio to rA-full-1.       Fang (2022), Fig. 3.10

    timing.py DIR       reads DIR/study.csv, writes DIR/timing.png
"""
from drawing import axis, by_scheme, directory, distinct, legend, plt, read, save, shown, times_and_ratios, where


def draw(folder):
    rows = [row for row in read(folder, "study.csv") if row["status"] == "ok"]
    problems, schemes = distinct(rows, "problem"), shown(distinct(rows, "integrator"))
    figure, panels = plt.subplots(2, len(problems), figsize=(1 + min(4.4, 10 / len(problems)) * len(problems), 7.4),
                                  squeeze=False, sharex=True)
    for problem, time, ratio in zip(problems, panels[0], panels[1]):
        for _, mine, look in by_scheme(rows):
            times_and_ratios(time, ratio, where(mine, problem=problem), "h", ms=6, **look)
        time.set_xscale("log")
        time.set_title(problem, fontsize=10)
        ratio.axhline(1, color="0.6", lw=1, zorder=0)
        for axes in (time, ratio):
            if len(schemes) > 5:  # the times then differ by up to a factor of ten
                axes.set_yscale("log")
            else:
                axes.set_ylim(bottom=0)
            axis(axes)
        ratio.set_xlabel("step $h$ [s]")
    panels[0][0].set_ylabel("thread CPU time per step [µs]")
    panels[1][0].set_ylabel("CPU time relative to rA-full-1")
    figure.suptitle("CPU time per step: median of the repeats, bars from minimum to maximum", fontsize=11)
    save(figure, folder, "timing.png", legend(figure, schemes, columns=5))


draw(directory())
