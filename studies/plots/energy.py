#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Change of the total energy over time, and its balance in models that are not conservative; one figure per problem.
                                                                                             Fang (2022), Fig. 3.5

    energy.py DIR       reads DIR/study.csv and DIR/energy.csv, writes DIR/energy-PROBLEM.png
"""
from drawing import (DASHES, along, axis, by_scheme, directory, distinct, for_each, legend, number, numbers, plt, record, save,
                     shown, step_styles, where)


def draw(folder, problem, runs, rows):
    schemes, steps = shown(distinct(rows, "integrator")), distinct(rows, "h")
    # results of earlier versions have no work
    models = record(directory()).get("models") or []
    balance = "balance" in rows[0] and any(m["problem"] == problem and not m["conservative"] for m in models)
    column, symbol = ("balance", "E - E_0 - W") if balance else ("drift", "E - E_0")
    figure, (plain, log) = plt.subplots(1, 2, figsize=(10.5, 4.8), sharex=True)
    for place, (_, of_scheme, look) in enumerate(by_scheme(rows)):
        for h in steps:
            mine = where(of_scheme, h=h)
            t, drift = numbers(mine, "t"), numbers(mine, column)
            dash = DASHES[steps.index(h) % len(DASHES)]
            along(plain, t, drift, place, len(schemes), dash, **look)
            # no point where the change is exactly zero, as at the start
            along(log, t, [abs(d) if d else float("nan") for d in drift], place, len(schemes), dash, **look)
    log.set_yscale("log")
    for axes, label in ((plain, f"${symbol}$ [J]"), (log, f"$|{symbol}|$ [J]")):
        axis(axes, "$t$ [s]", label)
    kinetic = max((number(run["max_kinetic"]) for run in runs if run["status"] == "ok"), default=float("nan"))
    which, more = step_styles(steps)
    figure.suptitle(f"{problem}: {'energy minus work of loads and drivers' if balance else 'change of the total energy'}, {which}; largest kinetic energy {kinetic:.4g} J", fontsize=11)
    save(figure, folder, f"energy-{problem}.png", legend(figure, schemes, more=more))


for_each("problem", draw, "energy.csv")
