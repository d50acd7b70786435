#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two-link arm whose bucket digs in a bed of grains, in co-simulation.

    granular-bucket.py DIR     reads DIR/study.csv, DIR/motion.csv and DIR/grains.csv, writes DIR/granular-bucket.png
"""
from drawing import COLOURS, directory, distinct, grid, number, numbers, plt, read, save, spheres, where

GRAIN = 7e-3  # [m]


def picture(axes, grains, motion):
    """The grains in the plane of the bucket at the end, coloured by their height, and the path of its centre of mass"""
    middle = [row for row in grains if abs(number(row["y"]) - 0.1) < 0.045]
    spheres(axes, middle, GRAIN, numbers(middle, "z"), 0.4, linewidths=0.2, edgecolors="0.3")
    axes.plot([1000 * x for x in numbers(motion, "x")], [1000 * z for z in numbers(motion, "z")], "k--", lw=1)
    axes.set(xlim=(0, 500), ylim=(0, 450), aspect="equal", xlabel="x [mm]", ylabel="z [mm]", title=motion[0]["test"])


def draw(folder):
    rows, motion, grains = (read(folder, table) for table in ("study.csv", "motion.csv", "grains.csv"))
    tests = distinct(rows, "test")
    figure, panels = plt.subplots(2, 3, figsize=(13, 8.5))
    for axes, (column, label) in zip(panels[0], [("Fx", "horizontal force on the bucket [N]"), ("Fz", "vertical force on the bucket [N]"),
                                                ("work", "work on the grains [J]")]):
        for k, test in enumerate(tests):
            mine = where(motion, test=test)
            axes.plot(numbers(mine, "t"), numbers(mine, column), "-", color=COLOURS[k], lw=1, label=test)
        grid(axes)
        axes.set(xlabel="time [s]", ylabel=label)
        axes.legend(frameon=False, fontsize=8)
    for axes, test in zip(panels[1], ("reference", "less friction")):
        picture(axes, where(grains, test=test), where(motion, test=test))
    axes = panels[1][2]
    for k, (column, label) in enumerate([("held", "mass of the grains held"), ("weight", "force at rest over g")]):
        axes.bar([n + 0.4 * k for n in range(len(rows))], [value / (1 if column == "held" else 9.81) for value in numbers(rows, column)],
                 width=0.38, color=COLOURS[k], label=label)
    axes.set_xticks([n + 0.2 for n in range(len(rows))], tests, rotation=20, fontsize=8)
    axes.set(ylabel="mass [kg]", ylim=(0, 1.3 * max(numbers(rows, "held"))))
    axes.legend(frameon=False, fontsize=8)
    save(figure, folder, "granular-bucket.png", top=1)


draw(directory())
