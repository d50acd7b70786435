#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mass flow through the outlet of a hopper over its diameter.                      Beverloo et al. (1961), Eq. 1

    granular-hopper.py DIR     reads DIR/study.csv and DIR/motion.csv, writes DIR/granular-hopper.png
"""
import numpy as np

from drawing import COLOURS, directory, grid, number, numbers, plt, read, save, where

DIAMETER, GRAVITY = 4e-3, 9.81  # mean diameter of the grains [m], [m/s²]
BEGIN, END = 0.15, 0.5          # the flow is that of this time [s]


def draw(folder):
    rows, motion = read(folder, "study.csv"), read(folder, "motion.csv")
    whole = where(rows, bed="whole")
    outlets, flow = np.array(numbers(whole, "D")), np.array(numbers(whole, "W"))
    density, C, k = (number(rows[0][column]) for column in ("bulk_density", "C", "k"))

    def law(D):
        return C * density * GRAVITY ** 0.5 * (D - k * DIAMETER) ** 2.5

    figure, (time, rate, residual) = plt.subplots(1, 3, figsize=(12, 4))
    for n, row in enumerate(rows):
        mine = where(motion, bed=row["bed"], D=row["D"])
        name = f"{number(row['D']) / DIAMETER:g} d" + ("" if row["bed"] == "whole" else f", {row['bed']}")
        time.plot(numbers(mine, "t"), numbers(mine, "left"), "-" if row["bed"] == "whole" else "--",
                  color=COLOURS[n % len(COLOURS)], lw=1.3, label=name)
    time.axvspan(BEGIN, END, color="0.92", zorder=0)
    time.set(xlabel="time [s]", ylabel="mass that has left [kg]", xlim=(0, None), ylim=(0, None))
    time.legend(frameon=False, fontsize=8)

    line = np.linspace(k * DIAMETER, 1.05 * outlets[-1], 200)
    rate.plot(line / DIAMETER, law(line), "-", color="0.35", lw=1, label=rf"$C = {C:.3f}$, $k = {k:.2f}$")
    rate.plot(outlets / DIAMETER, flow, "o", color=COLOURS[0], ms=5, label="whole bed")
    for n, name in enumerate(("lower", "refilled"), 1):
        other = where(rows, bed=name)
        rate.plot(np.array(numbers(other, "D")) / DIAMETER, numbers(other, "W"), "x+"[n - 1], color=COLOURS[n], ms=8,
                  label=f"{name} bed")
        residual.plot(np.array(numbers(other, "D")) / DIAMETER,
                      100 * (np.array(numbers(other, "W")) / law(np.array(numbers(other, "D"))) - 1), "x+"[n - 1],
                      color=COLOURS[n], ms=8)
    rate.set(xlabel="outlet $D/d$", ylabel="mass flow $W$ [kg/s]", xlim=(0, None), ylim=(0, None))
    rate.legend(frameon=False, fontsize=8)

    residual.axhline(0, color="0.35", lw=1)
    residual.plot(outlets / DIAMETER, 100 * (flow / law(outlets) - 1), "o", color=COLOURS[0], ms=5)
    residual.set(xlabel="outlet $D/d$", ylabel="flow over the law, less 1 [%]", ylim=(-6, 6))
    for axes in (time, rate, residual):
        grid(axes)
    save(figure, folder, "granular-hopper.png", top=1)


draw(directory())
