#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Error over step size for evolving contacts, one figure per problem.

    evolving-order.py DIR       reads DIR/study.csv, writes DIR/evolving-order-PROBLEM.png
"""
from drawing import SLOPES, distinct, for_each_problem, grid, legend, plt, save, slopes, style, where

PANELS = [("r", "position $r$ [m]"), ("A", "orientation $\\|A\\|_F$"), ("alpha", r"contact points $\bar\alpha$ [m]"),
          ("F_N", "normal force $F_N$ [N]")]
ROUNDING = 1e-9  # the limit of the fit in the study


def draw(folder, problem, rows):
    schemes = distinct(rows, "integrator")
    figure, all_axes = plt.subplots(1, 4, figsize=(16, 4.8), sharex=True)
    for (norm, title), axes in zip(PANELS, all_axes):
        points = []
        for scheme in schemes:
            colour, marker = style(scheme, schemes)
            mine = [row for row in where(rows, integrator=scheme) if row["error_" + norm] and float(row["error_" + norm]) > ROUNDING]
            h, e = [float(row["h"]) for row in mine], [float(row["error_" + norm]) for row in mine]
            points += zip(h, e)
            axes.loglog(h, e, "-", color=colour, marker=marker, lw=1.4, ms=6)
        h = sorted({p[0] for p in points})
        if len(h) > 1:
            slopes(axes, h, 1.8 * max(p[1] for p in points))
            axes.set_xticks(h, [f"{x:g}" for x in h])
            axes.xaxis.set_minor_formatter(plt.NullFormatter())
        else:
            title += ": errors below rounding"
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("step $h$ [s]")
        grid(axes)
    all_axes[0].set_ylabel("largest error over the instants")
    figure.suptitle(f"{problem}: error over step size")
    save(figure, folder, f"evolving-order-{problem}.png", legend(figure, schemes, more=SLOPES))


if __name__ == "__main__":
    for_each_problem(draw)
