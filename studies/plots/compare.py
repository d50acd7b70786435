#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of several integrators on one model: the observable and the differences to the reference over time.

    compare.py DIR      reads DIR/study.csv and DIR/compare.csv, writes DIR/compare.png
"""
from drawing import (Line2D, along, axis, chosen, directory, distinct, legend, look, numbers, plt, read, save, shown)

PANELS = {"r": ("diff_r", "$r$ [m]"), "A": ("diff_A", "$A$"), "v": ("diff_v", "$\\dot r$ [m/s]"),
          "omega": ("diff_omega", "$\\bar\\omega$ [rad/s]")}


def draw(folder):
    runs, rows = read(folder, "study.csv"), read(folder, "compare.csv")
    schemes = shown(distinct(runs, "integrator"))
    t = numbers(rows, "t")
    names = chosen(["observable", *PANELS])
    differences = [PANELS[name] for name in names if name in PANELS]
    lines = -(-len(differences) // 2)
    top = 1 if "observable" in names else 0
    figure = plt.figure(figsize=(10.5, 1.2 + 2.8 * top + 2.3 * lines))
    layout = figure.add_gridspec(top + lines, 2, height_ratios=[1.3] * top + [1] * lines)
    if top:
        # "observable" is "watched" in results of earlier versions
        scalar = "observable" if "reference.observable" in rows[0] else "watched"
        axes = figure.add_subplot(layout[0, :])
        axes.plot(t, numbers(rows, "reference." + scalar), color="0.75", lw=5, zorder=1)
        for place, scheme in enumerate(schemes):
            along(axes, t, numbers(rows, f"{scheme}.{scalar}"), place, len(schemes), **look(scheme, schemes))
        body, component = (runs[0].get("observable_scalar") or runs[0]["watched_scalar"]).rsplit(".", 1)
        unit = {"r": "m", "v": "m/s", "w": "rad/s"}[component[0]]
        axis(axes, "$t$ [s]", f"${component[0]}_{component[1]}$ of {body} [{unit}]")
    for k, (column, symbol) in enumerate(differences):
        wide = len(differences) % 2 and k == len(differences) - 1
        axes = figure.add_subplot(layout[top + k // 2, :] if wide else layout[top + k // 2, k % 2])
        for place, scheme in enumerate(schemes):
            d = numbers(rows, f"{scheme}.{column}")
            along(axes, t[1:], [x if x > 0 else float("nan") for x in d[1:]], place, len(schemes), **look(scheme, schemes))
        axes.set_yscale("log")
        axis(axes, "$t$ [s]", "difference in " + symbol)
    steps = distinct([run for run in runs if run["h"]], "h")
    at = f", h = {float(steps[0]):g} s" if steps else ""
    figure.suptitle(f"{runs[0]['problem']}{at}: " + ("observable and " if top else "") + "differences to the reference "
                    "solution (norms over all bodies)", fontsize=11)
    more = [Line2D([], [], color="0.75", lw=5, label=runs[0]["reference"])] if top else []
    save(figure, folder, "compare.png", legend(figure, schemes, more=more))


draw(directory())
