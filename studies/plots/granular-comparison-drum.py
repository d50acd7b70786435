#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixing of grains of two sizes in a drum.                                       Dosta et al. (2024), case 2

    granular-comparison-drum.py DIR     reads DIR/study.csv, DIR/motion.csv and DIR/grains.csv, writes
                                        DIR/granular-comparison-drum.png
"""
import numpy as np

from drawing import COLOURS, directory, grid, number, numbers, plt, read, save, spheres, where

RADIUS = 100  # of the drum [mm]


def picture(axes, grains, title):
    """The grains of the middle slice, M1 and M2 in two colours [mm]"""
    for material, colour in (("M2", COLOURS[0]), ("M1", COLOURS[1])):
        spheres(axes, where(grains, material=material), facecolor=colour, edgecolor="white", linewidths=0.2)
        axes.plot([], [], "o", color=colour, ms=5, label=material)
    axes.legend(frameon=False, fontsize=8, ncol=2, loc="upper center", borderaxespad=1.5)
    axes.add_patch(plt.Circle((0, 0), RADIUS, fill=False, color="0.3", lw=1.2))
    axes.set(xlim=(-104, 104), ylim=(-104, 104), aspect="equal", xlabel="x [mm]", ylabel="z [mm]")
    axes.set_title(title, fontsize=9)


def draw(folder):
    row, motion, grains = read(folder, "study.csv")[0], read(folder, "motion.csv"), read(folder, "grains.csv")
    figure = plt.figure(figsize=(11, 7))
    panels = figure.add_gridspec(2, 6)
    times = sorted({number(p["t"]) for p in grains})
    for k, t in enumerate(times):
        picture(figure.add_subplot(panels[0, 2 * k:2 * (k + 1)]), [p for p in grains if number(p["t"]) == t], f"t = {t:.2f} s")
    zones, mixing = figure.add_subplot(panels[1, :3]), figure.add_subplot(panels[1, 3:])
    t = numbers(motion, "t")
    for n, zone in enumerate((1, 2)):
        for material, line in (("M1", "-"), ("M2", "--")):
            share = 100 * np.array(numbers(motion, f"zone{zone}_{material}")) / number(row[f"grains_{material}"])
            zones.plot(t, share, line, color=COLOURS[n], lw=1.3, label=f"zone {zone}, {material}")
    zones.set(xlabel="time [s]", ylabel="share of the grains of a kind [%]", xlim=(0, None), ylim=(0, None))
    mixing.plot(t, numbers(motion, "separation"), "-", color=COLOURS[2], lw=1.5)
    mixing.set(xlabel="time [s]", ylabel="distance of M1 and M2 [radius]", xlim=(0, None), ylim=(0, None))
    zones.legend(frameon=False, fontsize=8, ncol=2)
    for axes in (zones, mixing):
        grid(axes)
    save(figure, folder, "granular-comparison-drum.png", top=1)


draw(directory())
