#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Positions, angular velocities, energy and constraint norm of one run.

    trajectory.py DIR       reads DIR/trajectory.csv, writes DIR/trajectory.png
"""
import math
import os

from drawing import COLOURS, Line2D, directory, numbers, plt, read

DASHES = {"x": "-", "y": "--", "z": ":"}
MOST_BODIES = 8  # of longer chains, equally spaced bodies are drawn


def bodies_of(rows):
    names = [name[:-3] for name in rows[0] if name.endswith(".rx")]
    stride = math.ceil(len(names) / MOST_BODIES) or 1
    return names[stride - 1 :: stride]


def components(axes, rows, bodies, symbol, label):
    for colour, body in zip(COLOURS, bodies):
        for axis, dash in DASHES.items():
            axes.plot(numbers(rows, "t"), numbers(rows, f"{body}.{symbol}{axis}"), dash, color=colour, linewidth=1)
    axes.set_ylabel(label)


def draw(folder):
    rows = read(folder, "trajectory.csv")
    bodies = bodies_of(rows)
    t, energy = numbers(rows, "t"), numbers(rows, "energy")
    figure, axes = plt.subplots(2, 2, figsize=(10, 6.5), sharex=True, constrained_layout=True)

    components(axes[0][0], rows, bodies, "r", "position $r$ [m]")
    components(axes[0][1], rows, bodies, "w", "angular velocity $\\bar\\omega$ [rad/s]")

    axes[1][0].plot(t, [e - energy[0] for e in energy], color="black", linewidth=1)
    axes[1][0].set_ylabel(f"energy $E - E_0$ [J],  $E_0$ = {energy[0]:.6g} J")
    axes[1][1].plot(t, [max(c, 1e-17) for c in numbers(rows, "constraint_norm")], color="black", linewidth=1)
    axes[1][1].set_yscale("log")
    axes[1][1].set_ylabel("largest constraint residual [m or rad]")

    for row in axes:
        for panel in row:
            panel.grid(color="0.9", linewidth=0.6)
            panel.set_axisbelow(True)
    for panel in axes[1]:
        panel.set_xlabel("$t$ [s]")
    handles = [Line2D([], [], color=c, label=b) for c, b in zip(COLOURS, bodies)]
    handles += [Line2D([], [], color="0.4", linestyle=d, label=a) for a, d in DASHES.items()]
    figure.legend(handles=handles, loc="upper center", ncol=min(len(handles), 6),
                  fontsize=8, frameon=False, bbox_to_anchor=(0.5, 1.06))
    figure.savefig(os.path.join(folder, "trajectory.png"), dpi=150, bbox_inches="tight")


draw(directory())
