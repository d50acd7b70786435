#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prescribed motions, loads and powers of the drivers of hilda inverse.

    drives.py DIR      reads DIR/drives.csv, writes DIR/drives.png
"""
from drawing import COLOURS, Line2D, axis, directory, lines_below, numbers, plt, read_rows, save

PANELS = [("value", "prescribed motion $f$ [rad or m]"), ("load", "load $-\\lambda$ [N m or N]"),
          ("power", "power $-\\lambda\\,\\dot f$ [W]")]
MOST = 8


def draw(folder):
    rows = read_rows(folder, "drives.csv")
    names = [name[:-6] for name in rows[0] if name.endswith(".value")]
    shown = names[:MOST]
    figure, all_axes = plt.subplots(1, len(PANELS), figsize=(12, 3.9))
    for axes, (column, label) in zip(all_axes, PANELS):
        for colour, name in zip(COLOURS, shown):
            axes.plot(numbers(rows, "t"), numbers(rows, f"{name}.{column}"), color=colour, lw=1.2)
        axis(axes, "$t$ [s]", label)
    below = lines_below(figure, [Line2D([], [], color=c, label=name) for c, name in zip(COLOURS, shown)], 6)
    if len(shown) < len(names):
        figure.suptitle(f"the first {len(shown)} of {len(names)} drivers", fontsize=9)
    save(figure, folder, "drives.png", below, top=1)


draw(directory())
