#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Positions, angular velocities, energy and constraint norm of one run.

    trajectory.py DIR [--quantity r,omega,energy,constraint]      reads DIR/trajectory.csv, writes DIR/trajectory.png
"""
import math

from drawing import COLOURS, Line2D, axis, chosen, directory, lines_below, numbers, plt, read_rows, save

DASHES = {"x": "-", "y": "--", "z": ":"}
MOST_BODIES = 8  # of longer chains, equally spaced bodies are drawn


def bodies_of(rows):
    names = [name[:-3] for name in rows[0] if name.endswith(".rx")]
    stride = math.ceil(len(names) / MOST_BODIES) or 1
    return names[stride - 1 :: stride], len(names)


def components(axes, rows, bodies, symbol, label):
    for colour, body in zip(COLOURS, bodies):
        for direction, dash in DASHES.items():
            axes.plot(numbers(rows, "t"), numbers(rows, f"{body}.{symbol}{direction}"), dash, color=colour, lw=1.1)
    axis(axes, "$t$ [s]", label)


def energy(axes, rows):
    values = numbers(rows, "energy")
    axes.plot(numbers(rows, "t"), [e - values[0] for e in values], color="black", lw=1)
    axis(axes, "$t$ [s]", f"energy $E - E_0$ [J],  $E_0$ = {values[0]:.6g} J")


def constraint(axes, rows):
    norm = numbers(rows, "constraint_norm")
    axes.semilogy(numbers(rows, "t"), [c if c > 0 else float("nan") for c in norm], color="black", lw=1)
    axis(axes, "$t$ [s]", "constraint residual [m or rad]")


def draw(folder):
    rows = read_rows(folder, "trajectory.csv")
    bodies, all_bodies = bodies_of(rows)
    panels = {
        "r": lambda axes: components(axes, rows, bodies, "r", "position $r$ [m]"),
        "omega": lambda axes: components(axes, rows, bodies, "w", "angular velocity $\\bar\\omega$ [rad/s]"),
        "energy": lambda axes: energy(axes, rows),
        "constraint": lambda axes: constraint(axes, rows)}
    names = chosen(list(panels))
    if not any(numbers(rows, "constraint_norm")):  # a model without constraints
        names = [name for name in names if name != "constraint"]
    if not names:
        return
    lines, columns = -(-len(names) // 2), min(2, len(names))
    figure, all_axes = plt.subplots(lines, columns, figsize=(max(6, 5 * columns), 1 + 2.9 * lines), squeeze=False)
    for name, axes in zip(names, all_axes.flat):
        panels[name](axes)
    for axes in list(all_axes.flat)[len(names):]:
        axes.remove()
    below = 0.0
    if "r" in names or "omega" in names:
        handles = [Line2D([], [], color=c, label=b) for c, b in zip(COLOURS, bodies)]
        handles += [Line2D([], [], color="0.4", ls=d, label=a) for a, d in DASHES.items()]
        below = lines_below(figure, handles, 7)
    if len(bodies) < all_bodies:
        figure.suptitle(f"{len(bodies)} of {all_bodies} bodies: {', '.join(bodies)}", fontsize=9)
    save(figure, folder, "trajectory.png", below, top=1)


draw(directory())
