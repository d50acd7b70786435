#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against step, one figure for each problem in study.csv.   Fang (2022), Figs. 3.4, 3.6, 3.7, 3.8

    convergence.py DIR      reads DIR/study.csv, writes DIR/convergence-PROBLEM.png
"""
from drawing import Line2D, distinct, for_each_problem, grid, legend, plt, save, style, where

PANELS = [
    [("r", "position $r$ [m]"), ("A", "orientation $\\|A\\|_F$"), ("v", "velocity $\\dot r$ [m/s]"),
     ("omega", "angular velocity $\\bar\\omega$ [rad/s]"), ("Q", "joint loads, relative")],
    [("r_end", "position [m]"), ("A_end", "orientation"), ("v_end", "velocity [m/s]"),
     ("omega_end", "angular velocity [rad/s]"), ("watched", "")],
]
UNITS = {"r": "m", "v": "m/s", "w": "rad/s"}


def slopes(axes, points):
    """Thin lines of slope 1 and 2 from above the largest error."""
    h = sorted({p[0] for p in points})
    if len(h) < 2:
        return
    top = max(p[1] for p in points)
    for slope, line in ((1, ":"), (2, "--")):
        at_end = 1.8 * top
        axes.plot([h[0], h[-1]], [at_end * (h[0] / h[-1]) ** slope, at_end], line, color="0.6", lw=1, zorder=0)


def draw(folder, problem, rows):
    schemes = distinct(rows, "integrator")
    figure, all_axes = plt.subplots(2, 5, figsize=(18, 7.6), sharex=True)
    watched = rows[0]["watched_scalar"]
    body, component = watched.rsplit(".", 1)
    for panels, line in zip(PANELS, all_axes):
        for (norm, title), axes in zip(panels, line):
            points = []
            for scheme in schemes:
                colour, marker = style(scheme, schemes)
                mine = [row for row in where(rows, integrator=scheme) if row[norm] not in ("", "0")]
                h = [float(row["h"]) for row in mine]
                e = [float(row[norm]) for row in mine]
                points += [(x, y) for x, y, row in zip(h, e, mine) if row["floor_" + norm] != "1"]
                axes.loglog(h, e, "-", color=colour, lw=1.4)
                for hollow in (False, True):
                    chosen = [n for n, row in enumerate(mine) if (row["floor_" + norm] == "1") == hollow]
                    axes.loglog([h[n] for n in chosen], [e[n] for n in chosen], marker, color=colour,
                                mfc="white" if hollow else colour, ms=6)
            if points:
                slopes(axes, points)
            axes.set_title(title or f"${component[0]}_{component[1]}$ of {body} [{UNITS[component[0]]}], norm of Fig. 3.4",
                           fontsize=10)
            grid(axes)
    all_axes[0][0].set_ylabel("error, rms over the instants")
    all_axes[1][0].set_ylabel(f"error at the end, {body}")
    for axes in all_axes[1]:
        axes.set_xlabel("step $h$ [s]")
    more = [Line2D([], [], color="0.6", ls=":", label="slope 1"), Line2D([], [], color="0.6", ls="--", label="slope 2"),
            Line2D([], [], color="0.3", marker="o", mfc="white", ls="", label="at rounding or Newton tolerance")]
    figure.suptitle(f"{problem}: error against step size")
    save(figure, folder, f"convergence-{problem}.png", legend(figure, schemes, more=more, columns=9))


if __name__ == "__main__":
    for_each_problem(draw)
