#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Change of the total energy over time, one figure per problem.                              Fang (2022), Fig. 3.5

    energy.py DIR       reads DIR/study.csv and DIR/energy.csv, writes DIR/energy-PROBLEM.png
"""
from drawing import DASHES, Line2D, axis, by_scheme, distinct, for_each, legend, number, numbers, plt, save, where, width


def draw(folder, problem, runs, rows):
    schemes, steps = distinct(rows, "integrator"), distinct(rows, "h")
    figure, (plain, log) = plt.subplots(1, 2, figsize=(13, 5.2), sharex=True)
    for scheme, of_scheme, look in by_scheme(rows):
        for h in steps:
            mine = where(of_scheme, h=h)
            t, drift = numbers(mine, "t"), numbers(mine, "drift")
            dash = DASHES[steps.index(h) % len(DASHES)]
            plain.plot(t, drift, dash, color=look["color"], lw=width(scheme, schemes))
            log.plot(t[1:], [max(abs(d), 1e-16) for d in drift[1:]], dash, color=look["color"], lw=1)
    log.set_yscale("log")
    for axes, label in ((plain, "$E - E_0$ [J]"), (log, "$|E - E_0|$ [J]")):
        axis(axes, "$t$ [s]", label)
    kinetic = max(number(run["max_kinetic"]) for run in runs if run["status"] == "ok") if any(
        run["status"] == "ok" for run in runs) else float("nan")
    which = f"h = {float(steps[0]):g} s" if len(steps) == 1 else "line style: step h"
    figure.suptitle(f"{problem}: change of the total energy, {which}; largest kinetic energy {kinetic:.4g} J", fontsize=11)
    more = [Line2D([], [], color="0.4", ls=DASHES[k % len(DASHES)], label=f"h = {float(h):g} s")
            for k, h in enumerate(steps)] if len(steps) > 1 else []
    save(figure, folder, f"energy-{problem}.png", legend(figure, schemes, markers=False, more=more))


for_each("problem", draw, "energy.csv")
