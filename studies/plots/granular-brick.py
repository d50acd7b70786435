#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliding distance of a brick over the friction coefficient.                                    Fang (2022), Fig. 7.4

    granular-brick.py DIR       reads DIR/study.csv and DIR/motion.csv, writes DIR/granular-brick.png
"""
from drawing import COLOURS, Line2D, directory, grid, number, numbers, plt, read, save, where


def draw(folder):
    rows, motion = read(folder, "study.csv"), read(folder, "motion.csv")
    mindlin, incremental = where(rows, law="mindlin"), where(rows, law="mindlin-incremental")
    printed = where(rows, law="mindlin, spring_bound")
    mu = numbers(mindlin, "mu")
    figure, (speed, distance, difference) = plt.subplots(1, 3, figsize=(11, 4))

    for k, row in enumerate(r for r in mindlin if round(number(r["mu"]), 6) in (0.1, 0.2, 0.5)):
        mine = where(motion, mu=row["mu"])
        t, v = numbers(mine, "t"), numbers(mine, "v")
        stops = 2 * number(row["coulomb"]) / v[0]
        speed.plot([0, stops], [v[0], 0], "-", color=COLOURS[k], lw=1)
        speed.plot(t[::10] + t[-1:], v[::10] + v[-1:], "o", color=COLOURS[k], ms=4.5)
        speed.annotate(rf"$\mu = {number(row['mu']):g}$", (0.88 * stops, 0.12 * v[0]), xytext=(4, 2),
                       textcoords="offset points", color=COLOURS[k], fontsize=9)
    speed.set(xlabel="time $t$ [s]", ylabel="speed $v$ [m/s]", xlim=(0, 5.6), ylim=(-0.05, 5.2))
    speed.legend(handles=[Line2D([], [], color="0.35", lw=1, label=r"$v_i - \mu g t$"),
                          Line2D([], [], color="0.35", ls="", marker="o", ms=4.5, label="measured")], frameon=False)

    fine = [0.09 + 0.002 * k for k in range(212)]
    scale = numbers(mindlin, "coulomb")[0] * mu[0]
    distance.plot(fine, [scale / m for m in fine], "-", color="0.35", lw=1.2, label=r"$v_i^2/2\mu g$")
    distance.plot(mu, numbers(mindlin, "distance"), "o", color=COLOURS[0], ms=6, label="measured")
    distance.plot(numbers(printed, "mu"), numbers(printed, "distance"), "x", color=COLOURS[3], ms=7,
                  label="bound of the spring alone")
    distance.set(xlabel=r"friction coefficient $\mu$", ylabel="sliding distance [m]", ylim=(0, None))
    distance.legend(frameon=False)

    difference.plot(mu, [s / c - 1 for s, c in zip(numbers(mindlin, "with_spring"), numbers(mindlin, "coulomb"))], "-",
                    color="0.35", lw=1.2, label="closed form with friction spring")
    difference.plot(mu, numbers(mindlin, "difference"), "o", color=COLOURS[0], ms=6, label="integer positions")
    difference.plot(mu, numbers(mindlin, "difference_double"), "+", color=COLOURS[1], ms=9, mew=1.4,
                    label="double precision")
    difference.plot(numbers(incremental, "mu"), numbers(incremental, "difference"), "s", mfc="none", color=COLOURS[2], ms=9,
                    label="incremental law")
    difference.set(xlabel=r"friction coefficient $\mu$", ylabel=r"relative difference to $v_i^2/2\mu g$")
    difference.ticklabel_format(axis="y", style="sci", scilimits=(0, 0))
    difference.legend(frameon=False, fontsize=9)
    for axes in (speed, distance, difference):
        grid(axes)
    save(figure, folder, "granular-brick.png", top=1)


draw(directory())
