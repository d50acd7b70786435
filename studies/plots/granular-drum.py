#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flow of grains in a rotating drum.                                                           Fang (2022), Sec. 7.2.5

    granular-drum.py DIR     reads DIR/study.csv, DIR/surface.csv and DIR/grains.csv, writes DIR/granular-drum.png
"""
import math

from drawing import COLOURS, directory, grid, number, numbers, plt, read, save, spheres, where

DRUM = 30  # radius of the circle of the centres of the shell [mm]


def picture(axes, row, grains, surface):
    """The grains of the middle slice, coloured by their speed over that of the shell"""
    radius = 1000 * number(row["R"])
    drawn = spheres(axes, grains, number(row["R"]), numbers(grains, "speed"), 1.5, linewidths=0)
    axes.add_patch(plt.Circle((0, 0), DRUM - radius, fill=False, color="0.3", lw=1.2))
    if number(row["froude"]) < 0.2:
        axes.plot([1000 * x for x in numbers(surface, "x")], [1000 * z for z in numbers(surface, "z")], "-", color=COLOURS[1],
                  lw=1.3)
        slope = -math.tan(math.radians(number(row["angle"])))
        half = 0.4 * DRUM
        inside = [p for p in surface if abs(1000 * number(p["x"])) < half]
        middle = sum(1000 * number(p["z"]) for p in inside) / len(inside)
        axes.plot([-half, half], [middle - slope * half, middle + slope * half], "--", color="k", lw=1)
    axes.set(xlim=(-31, 31), ylim=(-31, 31), aspect="equal", xlabel="x [mm]", title=f"Fr = {number(row['froude']):g}")
    return drawn


def draw(folder):
    every = read(folder, "study.csv")
    first = every[0]["g"]
    rows, scaled = where(every, g=first), [row for row in every if row["g"] != first]
    grains, surface = read(folder, "grains.csv"), read(folder, "surface.csv")
    columns = len(rows) if len(rows) <= 5 else -(-len(rows) // 2)
    lines = -(-len(rows) // columns)
    figure = plt.figure(figsize=(13, 13.5 / columns * lines + 3.6))
    panels = figure.add_gridspec(lines + 1, 3 * columns, height_ratios=[13 / columns] * lines + [3.6])
    for k, row in enumerate(rows):
        line, column = divmod(k, columns)
        axes = figure.add_subplot(panels[line, 3 * column:3 * (column + 1)])
        mine = where(grains, froude=row["froude"], g=row["g"])
        drawn = picture(axes, row, mine, where(surface, froude=row["froude"], g=row["g"]))
        axes.set_ylabel("z [mm]" if column == 0 else "")
    bar = figure.colorbar(drawn, cax=axes.inset_axes([1.05, 0, 0.06, 1]))
    bar.set_label(r"speed over $\omega$ radius")
    angle, share, same = (figure.add_subplot(panels[lines, columns * k:columns * (k + 1)]) for k in range(3))

    froude = numbers(rows, "froude")
    flat = [row for row in rows if number(row["froude"]) < 0.2]
    angle.plot(numbers(flat, "froude"), numbers(flat, "angle"), "o-", color=COLOURS[0], label="surface")
    angle.plot(froude, numbers(rows, "centre_angle"), "s--", color=COLOURS[1], label="centre of mass")
    angle.set(xscale="log", xlabel="Froude number", ylabel="angle [°]", ylim=(0, None))
    share.plot(froude, [100 * value for value in numbers(rows, "covered")], "o-", color=COLOURS[2], label="rim covered")
    share.plot(froude, [100 * value for value in numbers(rows, "airborne")], "s-", color=COLOURS[3], label="airborne grains")
    share.set(xscale="log", xlabel="Froude number", ylabel="share [%]", ylim=(0, 105))
    for row in scaled:
        for other, look in ((where(rows, froude=row["froude"])[0], {"ls": "-", "lw": 4, "color": "0.75"}),
                            (row, {"ls": "--", "lw": 1.3, "color": COLOURS[1]})):
            mine = where(surface, froude=other["froude"], g=other["g"])
            same.plot([1000 * x for x in numbers(mine, "x")], [1000 * z for z in numbers(mine, "z")],
                      label=f"g = {number(other['g']):.4g} m/s², {number(other['omega']):.3g} rad/s", **look)
        same.set_title(f"surface at Fr = {number(row['froude']):g}", fontsize=10)
    same.set(xlabel="x [mm]", ylabel="z [mm]")
    for axes in (angle, share, same):
        grid(axes)
        axes.legend(frameon=False, fontsize=8)
    save(figure, folder, "granular-drum.png", top=1)


draw(directory())
