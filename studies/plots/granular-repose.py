#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Angle of repose of a heap over the friction and the rolling resistance of its grains.

    granular-repose.py DIR     reads DIR/study.csv, DIR/heaps.csv, DIR/surface.csv and DIR/spheres.csv, writes
                               DIR/granular-repose.png
"""
import math

import numpy as np

from drawing import COLOURS, directory, grid, number, numbers, plt, read, save, spheres, where

FROM, TO = 0.2, 0.8  # part of a flank that the line is fitted to


def picture(axes, row, heap, grains, surface):
    """The grains of a slice of one heap, its surface and the lines through its flanks [mm]"""
    spheres(axes, grains, facecolor="0.8", edgecolor="0.5", linewidths=0.3)
    x, z = 1000 * np.array(numbers(surface, "x")), 1000 * np.array(numbers(surface, "z"))
    axes.plot(x, z, "-", color=COLOURS[0], lw=1.2)
    edge = -x[0] + (x[1] - x[0]) / 2
    for side, name in ((-1, "left"), (1, "right")):
        inside = (side * x > FROM * edge) & (side * x < TO * edge)
        slope = -side * math.tan(math.radians(number(heap[name])))
        ends = side * edge * np.array([FROM, TO])
        axes.plot(ends, z[inside].mean() + slope * (ends - x[inside].mean()), "-", color=COLOURS[1], lw=1.8)
        axes.text(side * 0.75 * edge, 0.85 * z.max(), f"{number(heap[name]):.1f}°", color=COLOURS[1], ha="center", fontsize=9)
    axes.set(aspect="equal", xlabel="x [mm]", ylabel="z [mm]", xlim=(-1.05 * edge, 1.05 * edge), ylim=(-4, 1.1 * z.max()))
    axes.set_title(rf"$\mu$ = {row['mu']}, $\mu_r$ = {row['mu_r']}, seed 1", fontsize=9)


def draw(folder):
    every, heaps = read(folder, "study.csv"), read(folder, "heaps.csv")
    surface, slices = read(folder, "surface.csv"), read(folder, "spheres.csv")
    rows = where(every, speed=every[0]["speed"], E=every[0]["E"])
    mu_r = rows[0]["mu_r"]
    over_mu = where(rows, mu_r=mu_r)
    mu = next(row["mu"] for row in rows if row["mu_r"] != mu_r)
    over_mu_r = sorted(where(rows, mu=mu), key=lambda row: number(row["mu_r"]))

    figure = plt.figure(figsize=(12, 6.2))
    panels = figure.add_gridspec(2, 6)
    for k, row in enumerate((over_mu[0], where(over_mu, mu=mu)[0])):
        axes = figure.add_subplot(panels[0, 3 * k:3 * (k + 1)])
        mine = {"mu": row["mu"], "mu_r": mu_r, "speed": row["speed"], "E": row["E"], "seed": "1"}
        picture(axes, row, where(heaps, **mine)[0], where(slices, **mine), where(surface, **mine))

    profile, first, second = (figure.add_subplot(panels[1, 2 * k:2 * (k + 1)]) for k in range(3))
    for n, row in enumerate(over_mu + [r for r in over_mu_r if r["mu_r"] != mu_r]):
        mine = where(surface, mu=row["mu"], mu_r=row["mu_r"], speed=row["speed"], E=row["E"])
        x = np.array(numbers(mine, "x")).reshape(int(number(row["seeds"])), -1)
        z = np.array(numbers(mine, "z")).reshape(x.shape)
        profile.plot(1000 * x[0], 1000 * z.mean(axis=0), lw=1.2, color=COLOURS[n % len(COLOURS)],
                     label=rf"{row['mu']}, {row['mu_r']}")
    profile.set(xlabel="x [mm]", ylabel="mean height of the surface [mm]", ylim=(0, None))
    profile.legend(frameon=False, fontsize=7, title=r"$\mu$, $\mu_r$", title_fontsize=7, ncol=2, loc="lower center")
    for axes, chosen, name, symbol, fixed in (
            (first, over_mu, "mu", r"\mu", rf"$\mu_r$ = {mu_r}"), (second, over_mu_r, "mu_r", r"\mu_r", rf"$\mu$ = {mu}")):
        for row in chosen:
            mine = where(heaps, mu=row["mu"], mu_r=row["mu_r"], speed=row["speed"], E=row["E"])
            for side, marker in (("left", "<"), ("right", ">")):
                axes.plot(numbers(mine, name), numbers(mine, side), marker, color="0.6", ms=4,
                          label=f"{side} flanks" if row is chosen[0] else None)
        axes.errorbar(numbers(chosen, name), numbers(chosen, "angle"), numbers(chosen, "error"), fmt="o-", color=COLOURS[0], ms=5,
                      capsize=3, label="mean, standard error")
        axes.set(xlabel=rf"${symbol}$", ylabel="angle [°]", xlim=(0, None), ylim=(0, None))
        axes.set_title(fixed, fontsize=9)
        axes.legend(frameon=False, fontsize=8, loc="lower right")
    second.set_xlim(-0.005, None)
    for axes in (profile, first, second):
        grid(axes)
    save(figure, folder, "granular-repose.png", top=1)


draw(directory())
