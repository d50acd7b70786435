#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Depth of the crater of a ball in a bed of grains.                                            Fang (2022), Sec. 7.2.3

    granular-cratering.py DIR     reads DIR/study.csv and DIR/motion.csv, writes DIR/granular-cratering.png
"""
from drawing import COLOURS, directory, distinct, grid, number, numbers, plt, read, save, where

MU = 0.3


def draw(folder):
    rows, motion = read(folder, "study.csv"), read(folder, "motion.csv")
    sizes = distinct(rows, "R")
    figure, (depth, time, size) = plt.subplots(1, 3, figsize=(12, 4))

    most = 0
    for k, radius in enumerate(sizes):
        mine = where(rows, R=radius)
        x = [100 * s / MU for s in numbers(mine, "scale")]
        most = max(most, *x)
        depth.plot(x, [100 * d for d in numbers(mine, "depth")], "o", color=COLOURS[k], ms=5,
                   label=f"R = {1e3 * number(radius):g} mm")
    depth.plot([0, 1.05 * most], [0, 0.14 * 1.05 * most], "-", color="0.35", lw=1, label="0.14 (experiment)")
    depth.plot([0, 1.05 * most], [0, 0.122 * 1.05 * most], "--", color="0.35", lw=1, label="0.122 (Chrono::GPU)")
    depth.set(xlabel=r"$\mu^{-1} (\rho_b/\rho_g)^{1/2} D^{2/3} H^{1/3}$ [cm]", ylabel="depth $d$ [cm]", xlim=(0, None),
              ylim=(0, None))
    depth.legend(frameon=False, fontsize=8)

    finest = rows[0]["R"]
    for k, row in enumerate(where(rows, R=finest)):
        mine = where(motion, R=row["R"], density=row["density"], height=row["height"])
        time.plot([1e3 * t for t in numbers(mine, "t")], [-100 * d for d in numbers(mine, "depth")], "-",
                  color=COLOURS[k % len(COLOURS)], lw=1.3,
                  label=f"{number(row['density']) / 1000:g} g/cm³, {100 * number(row['height']):g} cm")
    time.set(xlabel="time [ms]", ylabel="lowest point of the ball [cm]", title=f"R = {1e3 * number(finest):g} mm")
    time.legend(frameon=False, fontsize=8)

    of = sorted(where(where(rows, height="0.1"), density="2200"), key=lambda row: number(row["R"]))
    size.plot([1e3 * r for r in numbers(of, "R")], numbers(of, "slope"), "o-", color=COLOURS[0])
    size.axhline(0.14, color="0.35", lw=1)
    size.axhline(0.122, color="0.35", lw=1, ls="--")
    size.set(xlabel="radius of the grains [mm]", ylabel=r"slope $d\,\mu/((\rho_b/\rho_g)^{1/2} D^{2/3} H^{1/3})$",
             xlim=(0, None), ylim=(0, 0.16), title="2.2 g/cm³ from 10 cm")
    for axes in (depth, time, size):
        grid(axes)
    save(figure, folder, "granular-cratering.png", top=1)


draw(directory())
