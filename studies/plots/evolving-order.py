#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Error over step size for evolving contacts, one figure per problem.

    evolving-order.py DIR       reads DIR/study.csv, writes DIR/evolving-order-PROBLEM.png
"""
from drawing import Line2D, distinct, for_each_problem, grid, legend, plt, save, style, where

PANELS = [("r", "position $r$ [m]"), ("A", "orientation $\\|A\\|_F$"), ("alpha", r"contact points $\bar\alpha$ [m]"),
          ("F_N", "normal force $F_N$ [N]")]
ROUNDING = 1e-9  # the limit of the fit in the study


def slopes(axes, h, top):
    """Reference lines of slope 1 and 2 above the largest error"""
    for slope, line in ((1, ":"), (2, "--")):
        axes.plot([h[0], h[-1]], [1.8 * top * (h[0] / h[-1]) ** slope, 1.8 * top], line, color="0.6", lw=1, zorder=0)


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
            slopes(axes, h, max(p[1] for p in points))
            axes.set_xticks(h, [f"{x:g}" for x in h])
            axes.xaxis.set_minor_formatter(plt.NullFormatter())
        else:
            title += ": errors below rounding"
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("step $h$ [s]")
        grid(axes)
    all_axes[0].set_ylabel("largest error over the instants")
    more = [Line2D([], [], color="0.6", ls=":", label="slope 1"), Line2D([], [], color="0.6", ls="--", label="slope 2")]
    figure.suptitle(f"{problem}: error over step size")
    save(figure, folder, f"evolving-order-{problem}.png", legend(figure, schemes, more=more))


if __name__ == "__main__":
    for_each_problem(draw)
