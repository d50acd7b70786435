#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of several integrators on one model: the observable and the differences to the reference over time.

    compare.py DIR      reads DIR/study.csv and DIR/compare.csv, writes DIR/compare.png
"""
from drawing import Line2D, axis, directory, distinct, legend, numbers, plt, read, save, style, width

PANELS = [("diff_r", "$r$ [m]"), ("diff_A", "$A$"), ("diff_v", "$\\dot r$ [m/s]"),
          ("diff_omega", "$\\bar\\omega$ [rad/s]")]


def draw(folder):
    runs, rows = read(folder, "study.csv"), read(folder, "compare.csv")
    schemes = distinct(runs, "integrator")
    t = numbers(rows, "t")
    figure = plt.figure(figsize=(13, 8.2))
    layout = figure.add_gridspec(3, 2, height_ratios=(1.3, 1, 1))
    # "observable" is "watched" in results of earlier versions
    scalar = "observable" if "reference.observable" in rows[0] else "watched"
    observable = figure.add_subplot(layout[0, :])
    observable.plot(t, numbers(rows, "reference." + scalar), color="0.75", lw=5, zorder=1)
    for scheme in schemes:
        observable.plot(t, numbers(rows, f"{scheme}.{scalar}"), color=style(scheme, schemes)[0],
                        lw=width(scheme, schemes, 1, 2.5), zorder=2)
    body, component = (runs[0].get("observable_scalar") or runs[0]["watched_scalar"]).rsplit(".", 1)
    unit = {"r": "m", "v": "m/s", "w": "rad/s"}[component[0]]
    axis(observable, "$t$ [s]", f"${component[0]}_{component[1]}$ of {body} [{unit}]")
    for k, (column, symbol) in enumerate(PANELS):
        axes = figure.add_subplot(layout[1 + k // 2, k % 2], sharex=observable)
        for scheme in schemes:
            d = numbers(rows, f"{scheme}.{column}")
            axes.semilogy(t[1:], [x if x > 0 else float("nan") for x in d[1:]], color=style(scheme, schemes)[0], lw=1)
        axis(axes, "$t$ [s]", "difference in " + symbol)
    steps = distinct([run for run in runs if run["h"]], "h")
    at = f", h = {float(steps[0]):g} s" if steps else ""
    figure.suptitle(f"{runs[0]['problem']}{at}: observable and differences to the reference solution "
                    "(norms over all bodies)", fontsize=11)
    more = [Line2D([], [], color="0.75", lw=5, label=runs[0]["reference"])]
    save(figure, folder, "compare.png", legend(figure, schemes, markers=False, more=more))


draw(directory())
