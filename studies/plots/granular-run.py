#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Energy, contacts, stress and the loads on the boundaries over the time of a granular run.

    granular-run.py DIR [--quantity energy,contacts,stress,force,torque]      reads DIR/run.csv, writes DIR/run.png

Force and torque are the magnitudes of the loads of the particles on a boundary, for the MOST_CURVES boundaries with the
largest loads; the caption names the others.
"""
import math

import options
from drawing import COLOURS, DASHES, Line2D, along, axis, chosen, directory, lines_below, numbers, plt, read, save

MARKERS = "osv^D<>P"


def magnitudes(rows, boundary, kind):
    return [math.hypot(*parts) for parts in zip(*(numbers(rows, f"{boundary}_{kind}{a}") for a in "xyz"))]


def energy(axes, rows, _):
    values = numbers(rows, "kinetic_energy")
    positive = [v if v > 0 else float("nan") for v in values]
    axes.plot(numbers(rows, "t"), positive, color="k", lw=1.1)
    if any(v > 0 for v in values):
        axes.set_yscale("log")
    axis(axes, "$t$ [s]", "kinetic energy [J]")


def contacts(axes, rows, _):
    axes.plot(numbers(rows, "t"), numbers(rows, "contacts"), color="k", lw=1.1, label="contacts")
    axes.plot(numbers(rows, "t"), numbers(rows, "pairs"), "--", color="0.5", lw=1.1, label="pairs of the neighbour list")
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=9)
    axis(axes, "$t$ [s]", "number")


def stress(axes, rows, _):
    for k, name in enumerate(("xx", "yy", "zz", "xy", "yz", "zx")):
        axes.plot(numbers(rows, "t"), numbers(rows, "stress_" + name), DASHES[k // 3], color=COLOURS[k], lw=1.1,
                  label=rf"$\sigma_{{{name}}}$")
    axes.legend(frameon=False, fontsize=9, ncol=2)
    axis(axes, "$t$ [s]", "stress of the contacts [Pa]")


def loads(kind, label):
    def draw_loads(axes, rows, boundaries):
        for k, boundary in enumerate(boundaries):
            along(axes, numbers(rows, "t"), magnitudes(rows, boundary, kind), k, len(boundaries),
                  color=COLOURS[k], marker=MARKERS[k])
        axis(axes, "$t$ [s]", label)
    return draw_loads


PANELS = {"energy": energy, "contacts": contacts, "stress": stress,
          "force": loads("F", "force on a boundary [N]"), "torque": loads("T", "torque on a boundary [N m]")}


def draw(folder):
    rows = read(folder, "run.csv")
    if len(rows) < 2:
        options.refuse("run.csv has fewer than two rows; a shorter --interval of the run gives more")
    boundaries = [name[:-3] for name in rows[0] if name.endswith("_Fx")]
    loaded = [b for b in boundaries if any(magnitudes(rows, b, "F")) or any(magnitudes(rows, b, "T"))]
    largest = sorted(loaded, key=lambda b: -max(magnitudes(rows, b, "F")))[:options.MOST_CURVES]
    shown = [b for b in boundaries if b in largest]
    # a panel without values is left out
    empty = {"energy": not any(numbers(rows, "kinetic_energy")), "contacts": not any(numbers(rows, "pairs")),
             "stress": not any(any(numbers(rows, f"stress_{a}{b}")) for a in "xyz" for b in "xyz"),
             "force": not any(any(magnitudes(rows, b, "F")) for b in shown),
             "torque": not any(any(magnitudes(rows, b, "T")) for b in shown)}
    names = [name for name in chosen(list(PANELS)) if not empty[name]]
    if not names:
        return
    lines, columns = -(-len(names) // 2), min(2, len(names))
    figure, all_axes = plt.subplots(lines, columns, figsize=(max(6, 5 * columns), 1 + 2.9 * lines), squeeze=False)
    for name, axes in zip(names, all_axes.flat):
        PANELS[name](axes, rows, shown)
    for axes in list(all_axes.flat)[len(names):]:
        axes.remove()
    below = 0.0
    if {"force", "torque"} & set(names):
        options.leave_out([b for b in loaded if b not in shown])
        below = lines_below(figure, [Line2D([], [], color=COLOURS[k], marker=MARKERS[k], ms=5, label=b)
                                     for k, b in enumerate(shown)])
    save(figure, folder, "run.png", below, top=1)


draw(directory())
