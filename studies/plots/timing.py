#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""CPU time per step over step size, by problem and scheme, and its ratio to rA-full-1.       Fang (2022), Fig. 3.10

    timing.py DIR       reads DIR/study.csv, writes DIR/timing.png
"""
from drawing import bars, directory, distinct, grid, legend, numbers, plt, read, save, style, where


def main():
    folder = directory()
    rows = [row for row in read(folder, "study.csv") if row["status"] == "ok"]
    problems, schemes = distinct(rows, "problem"), distinct(rows, "integrator")
    figure, panels = plt.subplots(2, len(problems), figsize=(1 + 4.4 * len(problems), 7.4), squeeze=False, sharex=True)
    for problem, time, ratio in zip(problems, panels[0], panels[1]):
        for scheme in schemes:
            colour, marker = style(scheme, schemes)
            mine = where(rows, problem=problem, integrator=scheme)
            h, us = numbers(mine, "h"), numbers(mine, "us_per_step")
            time.errorbar(h, us, yerr=bars(mine, "us_per_step"), fmt="-", marker=marker, color=colour, lw=1.2, ms=6, capsize=2, elinewidth=0.8)
            ratio.plot(h, numbers(mine, "ratio_to_full"), "-", marker=marker, color=colour, lw=1.2, ms=6)
        time.set_xscale("log")
        time.set_title(problem, fontsize=10)
        ratio.axhline(1, color="0.6", lw=1, zorder=0)
        for axes in (time, ratio):
            if len(schemes) > 5:  # the times then differ by up to a factor of ten
                axes.set_yscale("log")
            else:
                axes.set_ylim(bottom=0)
        ratio.set_xlabel("step $h$ [s]")
        for axes in (time, ratio):
            grid(axes)
    panels[0][0].set_ylabel("thread CPU time per step [µs]")
    panels[1][0].set_ylabel("CPU time relative to rA-full-1")
    figure.suptitle("CPU time per step: median of the repeats, bars from minimum to maximum", fontsize=11)
    save(figure, folder, "timing.png", legend(figure, schemes))


if __name__ == "__main__":
    main()
