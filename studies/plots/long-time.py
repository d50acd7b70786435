#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Change of the energy and of the angular momentum over decades of time; one figure per problem.

    long-time.py DIR       reads DIR/study.csv and DIR/decades.csv, writes DIR/long-time-PROBLEM.png
"""
from drawing import DASHES, axis, by_scheme, distinct, for_each, legend, numbers, plt, save, shown, step_styles, where


def draw(folder, problem, _, rows):
    schemes, steps = shown(distinct(rows, "integrator")), distinct(rows, "h")
    figure, panels = plt.subplots(1, 3, figsize=(13, 4.8), sharex=True)
    columns = (("energy_max", "largest $|E - E_0|$ in the decade [J]"), ("energy_mean", "$|$mean of $E - E_0|$ in the decade [J]"),
               ("momentum_max", "largest $|L - L_0|$ in the decade [N m s]"))
    for _, of_scheme, look in by_scheme(rows):
        for h in steps:
            mine = where(of_scheme, h=h)
            for axes, (column, _) in zip(panels, columns):
                # no point where the change is exactly zero
                values = [abs(x) if x else float("nan") for x in numbers(mine, column)]
                axes.plot(numbers(mine, "t"), values, ls=DASHES[steps.index(h) % len(DASHES)], **look)
    for axes, (_, label) in zip(panels, columns):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axis(axes, "$t$ [s], end of the decade", label)
    which, more = step_styles(steps)
    figure.suptitle(f"{problem}: energy, and angular momentum along gravity, by decade of time, {which}", fontsize=11)
    save(figure, folder, f"long-time-{problem}.png", legend(figure, schemes, more=more))


for_each("problem", draw, "decades.csv")
