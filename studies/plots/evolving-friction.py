#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Ball in an ellipsoidal bowl with friction and rolling resistance.                         Fang (2022), Figs. 5.7, 5.8

    evolving-friction.py DIR    reads DIR/curves.csv, writes DIR/evolving-friction-point.png and -forces.png
"""
from drawing import COLOURS, Line2D, axis, directory, distinct, lines_below, number, numbers, plt, read, save, where

DASHES = ["-", "--", "-.", (0, (1, 1))]
IDEAL = {"color": "black", "lw": 0.7, "ls": ":"}


def sets(rows):
    """The distinct runs for each rolling resistance, as pairs of integrator and step"""
    return list(dict.fromkeys((row["run"], row["h"]) for row in rows if row["run"] != "ideal"))


def legend(figure, rows, etas):
    lines = [Line2D([], [], color=COLOURS[k], label=rf"$\eta_r$ = {number(eta):g}") for k, eta in enumerate(etas)]
    of = sets(rows)
    lines += [Line2D([], [], color="0.4", ls=DASHES[k % len(DASHES)], label=f"{run}, h = {number(h):g} s")
              for k, (run, h) in enumerate(of)]
    if any(row["run"] == "ideal" for row in rows):
        lines.append(Line2D([], [], label="ideal limit: rolling without slip, no friction springs", **IDEAL))
    return lines_below(figure, lines, 6)


def draw(axes, rows, etas, across, up, x, y):
    for k, eta in enumerate(etas):
        for m, (run, h) in enumerate(sets(rows)):
            mine = where(rows, eta_r=eta, run=run, h=h)
            axes.plot(numbers(mine, across), numbers(mine, up), ls=DASHES[m % len(DASHES)], color=COLOURS[k], lw=1)
        ideal = where(rows, eta_r=eta, run="ideal")
        axes.plot(numbers(ideal, across), numbers(ideal, up), zorder=3, **IDEAL)
    axis(axes, x, y)


def point(folder, rows, etas):
    figure, axes = plt.subplots(1, 2, figsize=(10.8, 4.8))
    draw(axes[0], rows, etas, "t", "y", "$t$ [s]", "$y$ of the contact point [m]")
    # shifted, because all curves are on the same ellipse
    for k, eta in enumerate(etas):
        for m, (run, h) in enumerate(sets(rows)):
            mine = where(rows, eta_r=eta, run=run, h=h)
            lifted = [z + 0.12 * k for z in numbers(mine, "z")]
            axes[1].plot(numbers(mine, "y"), lifted, ls=DASHES[m % len(DASHES)], color=COLOURS[k], lw=1)
            axes[1].plot(number(mine[-1]["y"]), lifted[-1], "o", color=COLOURS[k], ms=4)
    axis(axes[1], "$y$ [m]", r"$z$ [m], shifted by 0.12 m for each $\eta_r$")
    axes[1].set_aspect("equal", adjustable="datalim")
    figure.suptitle("ball in a bowl with rolling resistance: contact point on the bowl", fontsize=11)
    save(figure, folder, "evolving-friction-point.png", legend(figure, rows, etas))


def forces(folder, rows, etas):
    figure, axes = plt.subplots(5, 1, figsize=(9, 11), sharex=True)
    names = {"F_N": "$|F_N|$ [N]", "F_f": "$|F_f|$ [N]", "torque": "rolling torque [N m]", "v": "$|v|$ [m/s]",
             "omega": r"$|\omega|$ [rad/s]"}
    for ax, (column, name) in zip(axes, names.items()):
        draw(ax, rows, etas, "t", column, "$t$ [s]" if column == "omega" else "", name)
    # the axis excludes the transient of the friction springs after the release
    late = [number(row["F_f"]) for row in rows if row["run"] != "ideal" and number(row["t"]) > 0.1]
    axes[1].set_ylim(0, 1.1 * max(late, default=1))
    save(figure, folder, "evolving-friction-forces.png", legend(figure, rows, etas))


def figures(folder):
    rows = read(folder, "curves.csv")
    etas = distinct(rows, "eta_r")
    point(folder, rows, etas)
    forces(folder, rows, etas)


figures(directory())
