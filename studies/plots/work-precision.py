#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Work-precision diagrams: error over CPU time, one figure per problem.

    work-precision.py DIR       reads DIR/study.csv, writes DIR/work-precision-PROBLEM.png
"""
from drawing import (Line2D, axis, by_scheme, chosen, distinct, for_each, legend, number, numbers, plt, save, shown)

# The cheapest integrators of each order, the default one and IDA come before others.
PREFERRED = ("rA-half-1-momentum", "rA-half-1-kick", "rA-rattle", "rA-rkmk-4", "rA-dp-5", "rA-dop853", "rA-rattle-6",
             "ida-rp-baumgarte")
PANELS = {"r": "position $r$, rms [m]", "v": "velocity $\\dot r$, rms [m/s]", "Q": "constraint loads, rms, relative"}
ROUNDING = 1e-11  # the reference solutions are accurate to about 1e-12; no smaller error is meaningful


def curve(axes, rows, norm, look):
    """Errors over CPU time; the markers of errors at rounding level are hollow"""
    t, e = [1e3 * s for s in numbers(rows, "cpu_seconds")], numbers(rows, norm)
    style = {key: value for key, value in look.items() if key != "marker"}
    axes.loglog(t, e, "-", lw=1.2, **style)
    for hollow in (False, True):
        points = [(x, y) for x, y in zip(t, e) if (y < ROUNDING) == hollow]
        axes.loglog([x for x, _ in points], [y for _, y in points], ls="", ms=5,
                    **look | ({"mfc": "white"} if hollow else {}))
    return min(e, default=1) < ROUNDING


def draw(folder, problem, rows):
    # a model without constraints has no loads
    names = [n for n in chosen(list(PANELS)) if any(number(row[n]) > 0 for row in rows)]
    at_rounding = [n for n in names if not any(number(row[n]) > ROUNDING for row in rows)]
    names = [n for n in names if n not in at_rounding]
    if not names:
        return
    figure, panels = plt.subplots(1, len(names), figsize=(max(6, 3.6 * len(names)), 4.6), sharex=True, squeeze=False)
    hollow = False
    for norm, axes in zip(names, panels[0]):
        for _, mine, look in by_scheme(rows, preferred=PREFERRED):
            mine = [row for row in mine if row["status"] == "ok" and number(row[norm]) > 0]
            hollow = curve(axes, mine, norm, look) or hollow
        axis(axes, "thread CPU time of the run [ms]", title=PANELS[norm])
        if norm == "r":
            axes.axhline(1e-3, color="0.6", lw=1, ls="--", zorder=0)
    panels[0][0].set_ylabel("error (units in the panel titles)")
    figure.suptitle(f"{problem}, end time {number(rows[0]['end']):g} s: error over CPU time; reference: {rows[0]['reference']}" +
                    (f"\nno panel, at rounding: {', '.join(at_rounding)}" if at_rounding else ""), fontsize=11)
    more = [Line2D([], [], color="0.3", marker="o", mfc="white", ls="", label="at rounding")] if hollow else []
    if "r" in names:
        more.append(Line2D([], [], color="0.6", lw=1, ls="--", label="position error of $10^{-3}$ m"))
    save(figure, folder, f"work-precision-{problem}.png",
         legend(figure, shown(distinct(rows, "integrator"), PREFERRED), more=more, columns=5))


for_each("problem", draw)
