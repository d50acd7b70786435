#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Impact of a steel ball on a bed of grains.                                       Dosta et al. (2024), case 3

    granular-comparison-penetration.py DIR     reads DIR/study.csv and DIR/motion.csv, writes
                                               DIR/granular-comparison-penetration.png
"""
import numpy as np

from drawing import COLOURS, directory, grid, number, numbers, plt, read, save, where


def draw(folder):
    rows, motion = read(folder, "study.csv"), read(folder, "motion.csv")
    figure, (height, speed) = plt.subplots(1, 2, figsize=(10, 4))
    for n, row in enumerate(rows):
        mine = where(motion, grains=row["grains"], softness=row["softness"])
        name = f"{number(row['grains']):g} grains" + ("" if row["softness"] == rows[0]["softness"] else r", 10 $E$")
        look = {"ls": "-" if row["softness"] == rows[0]["softness"] else "--", "color": COLOURS[n], "lw": 1.4, "label": name}
        t = 1000 * np.array(numbers(mine, "t"))
        height.plot(t, 1000 * np.array(numbers(mine, "z")), **look)
        speed.plot(t, numbers(mine, "v"), **look)
        if row["softness"] == rows[0]["softness"]:
            height.axhline(1000 * number(row["surface"]), color=COLOURS[n], lw=0.8, ls=":")
    height.axhline(10, color="0.35", lw=0.8)
    height.text(99, 10, "ball on the bottom", ha="right", va="bottom", fontsize=8, color="0.35")
    height.set(xlabel="time [ms]", ylabel="height of the centre of the ball [mm]", xlim=(0, None), ylim=(0, None))
    speed.set(xlabel="time [ms]", ylabel="velocity of the ball, upward [m/s]", xlim=(0, None))
    height.legend(frameon=False, fontsize=8)
    for axes in (height, speed):
        grid(axes)
    save(figure, folder, "granular-comparison-penetration.png", top=1)


draw(directory())
