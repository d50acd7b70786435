#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Error over step size for evolving contacts, one figure per problem.

    evolving-order.py DIR       reads DIR/study.csv, writes DIR/evolving-order-PROBLEM.png
"""
from drawing import SLOPES, axis, by_scheme, distinct, for_each, legend, number, numbers, plt, save, slopes

PANELS = [("r", "position $r$ [m]"), ("A", "orientation $\\|A\\|_F$"), ("alpha", r"contact points $\bar\alpha$ [m]"),
          ("F_N", "normal force $F_N$ [N]")]
ROUNDING = 1e-9  # the limit of the fit in the study


def draw(folder, problem, rows):
    figure, all_axes = plt.subplots(1, 4, figsize=(16, 4.8), sharex=True)
    for (norm, title), axes in zip(PANELS, all_axes):
        points = []
        for _, mine, look in by_scheme(rows):
            mine = [row for row in mine if number(row["error_" + norm]) > ROUNDING]
            h, e = numbers(mine, "h"), numbers(mine, "error_" + norm)
            points += zip(h, e)
            axes.loglog(h, e, "-", lw=1.4, ms=6, **look)
        h = sorted({p[0] for p in points})
        if len(h) > 1:
            slopes(axes, h, 1.8 * max(p[1] for p in points))
            axes.set_xticks(h, [f"{x:g}" for x in h])
            axes.xaxis.set_minor_formatter(plt.NullFormatter())
        else:
            title += ": errors below rounding"
        axis(axes, "step $h$ [s]", title=title)
    all_axes[0].set_ylabel("largest error over the instants")
    figure.suptitle(f"{problem}: error over step size")
    save(figure, folder, f"evolving-order-{problem}.png", legend(figure, distinct(rows, "integrator"), more=SLOPES))


for_each("problem", draw)
