#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of a granular run.

    granular-run.py DIR [--quantity energy,momentum,...]

reads DIR/run.csv and writes DIR/run.png: energies, momentum, numbers of contacts and particles, mass flow, stress, loads on
the boundaries and the motion of those that move, over time. Force and torque are the magnitudes of the loads of the particles
on a boundary, for the MOST_CURVES boundaries with the largest loads; the caption names the others. A panel without values is
left out. DIR/loads.csv becomes DIR/loads.png, and each DIR/fields-NAME.csv becomes DIR/fields-NAME.png.
"""
import math
import os

import granular_fields
import granular_loads
import options
from drawing import COLOURS, DASHES, Line2D, along, axis, chosen, directory, lines_below, numbers, plt, read_rows, save

MARKERS = "osv^D<>P"


def magnitudes(rows, boundary, kind):
    return [math.hypot(*parts) for parts in zip(*(numbers(rows, f"{boundary}_{kind}{a}") for a in "xyz"))]


def column(rows, name):
    """The numbers of a column; zeros if an earlier version has not written it"""
    return numbers(rows, name) if name in rows[0] else [0.0] * len(rows)


def energy(axes, rows, _):
    for name, dash, label in (("kinetic_energy", "-", "kinetic"), ("rotational_energy", "--", "of it rotational")):
        values = column(rows, name)
        if any(v > 0 for v in values):
            axes.plot(numbers(rows, "t"), [v if v > 0 else math.nan for v in values], dash, color="k", lw=1.1, label=label)
            axes.set_yscale("log")
    axes.legend(frameon=False, fontsize=9)
    axis(axes, "$t$ [s]", "energy [J]")


def potential(axes, rows, _):
    axes.plot(numbers(rows, "t"), column(rows, "potential_energy"), color="k", lw=1.1)
    axis(axes, "$t$ [s]", "potential energy [J]")


def momentum(axes, rows, _):
    for k, a in enumerate("xyz"):
        along(axes, numbers(rows, "t"), column(rows, "momentum_" + a), k, 3, color=COLOURS[k], marker=MARKERS[k], label=a)
    axes.legend(frameon=False, fontsize=9)
    axis(axes, "$t$ [s]", "momentum [kg m/s]")


def contacts(axes, rows, _):
    axes.plot(numbers(rows, "t"), numbers(rows, "contacts"), color="k", lw=1.1, label="contacts")
    axes.plot(numbers(rows, "t"), numbers(rows, "pairs"), "--", color="0.5", lw=1.1, label="pairs of the neighbour list")
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=9)
    axis(axes, "$t$ [s]", "number")


def particles(axes, rows, _):
    axes.plot(numbers(rows, "t"), column(rows, "particles"), color="k", lw=1.1, label="particles")
    if any(column(rows, "removed")):
        axes.plot(numbers(rows, "t"), column(rows, "removed"), "--", color="0.5", lw=1.1, label="removed")
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=9)
    axis(axes, "$t$ [s]", "number")


def flow(axes, rows, _):
    for name, style, label in (("inserted_mass_rate", {"ls": "--", "color": "0.5"}, "inserted"),
                               ("removed_mass_rate", {"color": "k"}, "removed")):
        if any(column(rows, name)):
            axes.plot(numbers(rows, "t"), column(rows, name), lw=1.1, label=label, **style)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=9)
    axis(axes, "$t$ [s]", "mass flow [kg/s]")


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


def moving_parts(rows, kind):
    """Names and values of the columns BOUNDARY_kind{x,y,z} that are not constant; of positions the displacements"""
    parts = []
    for name in rows[0]:
        if name[:-1].endswith("_" + kind) and name[-1] in "xyz" and name[:-len(kind) - 1] + "wz" in rows[0]:
            values = numbers(rows, name)
            if kind == "":
                values = [v - values[0] for v in values]
            size = max(map(abs, values))
            if size > 0 and not (kind == "" and size < 1e-12):
                parts.append((f"{name[:-len(kind) - 2]} {name[-1]}", values))
    return parts


def motion(kind, label):
    def draw_motion(axes, rows, _):
        parts = sorted(moving_parts(rows, kind), key=lambda part: -max(map(abs, part[1])))[:options.MOST_CURVES]
        for k, (name, values) in enumerate(parts):
            along(axes, numbers(rows, "t"), values, k, len(parts), color=COLOURS[k], marker=MARKERS[k], label=name)
        axes.legend(frameon=False, fontsize=9, ncol=1 + len(parts) // 5)
        axis(axes, "$t$ [s]", label)
    return draw_motion


PANELS = {"energy": energy, "potential": potential, "momentum": momentum, "contacts": contacts, "particles": particles,
          "flow": flow, "stress": stress, "force": loads("F", "force on a boundary [N]"),
          "torque": loads("T", "torque on a boundary [N m]"),
          "displacement": motion("", "displacement of a boundary [m]"), "velocity": motion("v", "velocity of a boundary [m/s]"),
          "rotation": motion("w", "angular velocity of a boundary [rad/s]")}


def empty_panels(rows, shown):
    """The quantities without values in this run"""
    def none(*names):
        return not any(any(column(rows, name)) for name in names)

    return {name for name, is_empty in {
        "energy": none("kinetic_energy"), "potential": none("potential_energy"),
        "momentum": none("momentum_x", "momentum_y", "momentum_z"), "contacts": none("pairs"),
        "particles": len(set(column(rows, "particles"))) == 1 and none("removed"),
        "flow": none("inserted_mass_rate", "removed_mass_rate"),
        "stress": none(*(f"stress_{a}{b}" for a in "xyz" for b in "xyz")),
        "force": not any(any(magnitudes(rows, b, "F")) for b in shown),
        "torque": not any(any(magnitudes(rows, b, "T")) for b in shown),
        "displacement": not moving_parts(rows, ""), "velocity": not moving_parts(rows, "v"),
        "rotation": not moving_parts(rows, "w")}.items() if is_empty}


def draw(folder, quantities):
    rows = read_rows(folder, "run.csv")
    if len(rows) < 2:
        options.refuse("run.csv has fewer than two rows; a shorter --interval of the run gives more")
    boundaries = [name[:-3] for name in rows[0] if name.endswith("_Fx")]
    loaded = [b for b in boundaries if any(magnitudes(rows, b, "F")) or any(magnitudes(rows, b, "T"))]
    largest = sorted(loaded, key=lambda b: -max(magnitudes(rows, b, "F")))[:options.MOST_CURVES]
    shown = [b for b in boundaries if b in largest]
    empty = empty_panels(rows, shown)
    names = [name for name in PANELS if name in quantities and name not in empty]
    if not names:
        return
    columns = min(3 if len(names) > 6 else 2, len(names))
    lines = -(-len(names) // columns)
    figure, all_axes = plt.subplots(lines, columns, figsize=(min(11, max(6, 5 * columns)), 1 + 2.9 * lines), squeeze=False)
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
    options.leave_out([])


def main():
    folder = directory()
    of_fields = [name for name in granular_fields.QUANTITIES if name not in PANELS]
    quantities = chosen([*PANELS, *of_fields])
    draw(folder, quantities)
    if os.path.exists(os.path.join(folder, "loads.csv")):
        granular_loads.draw(folder, quantities)
    granular_fields.draw_all(folder, quantities)


main()
