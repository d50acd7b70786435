#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grains in a silo that empties, over time.                                       Dosta et al. (2024), case 1

    granular-comparison-silo.py DIR     reads DIR/study.csv and DIR/motion.csv, writes DIR/granular-comparison-silo.png
"""
import numpy as np

from drawing import COLOURS, directory, grid, number, numbers, plt, read, save, where


def draw(folder):
    rows, motion = read(folder, "study.csv"), read(folder, "motion.csv")
    figure, (time, rate) = plt.subplots(1, 2, figsize=(10, 4), width_ratios=(3, 2))
    for n, row in enumerate(rows):
        mine = where(motion, orifice=row["orifice"], material=row["material"])
        name = f"{1000 * number(row['orifice']):g} mm, {row['material']}"
        time.plot(numbers(mine, "t"), np.array(numbers(mine, "retained")) / 1000, "-" if row["material"] == "M1" else "--",
                  color=COLOURS[n // 2], lw=1.5, label=name)
        rate.bar(n, number(row["rate"]) / 1000, color=COLOURS[n // 2], alpha=1 if row["material"] == "M1" else 0.55)
        rate.text(n, number(row["rate"]) / 1000, f"{number(row['mass_rate']):.2f} kg/s", ha="center", va="bottom", fontsize=8)
    time.set(xlabel="time [s]", ylabel="grains above the orifice [1000]", xlim=(0, None), ylim=(0, None))
    time.legend(frameon=False, fontsize=8, title="orifice, material", title_fontsize=8)
    rate.set_xticks(range(len(rows)), [f"{1000 * number(row['orifice']):g} mm\n{row['material']}" for row in rows])
    rate.set(ylabel="rate [1000 grains/s]")
    rate.margins(y=0.12)
    grid(time)
    save(figure, folder, "granular-comparison-silo.png", top=1)


draw(directory())
