#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Critical mass of a stack of three spheres over rolling resistance and friction.                Fang (2022), Fig. 7.7

    granular-stacking.py DIR     reads DIR/study.csv and DIR/friction.csv, writes DIR/granular-stacking.png
"""
from drawing import COLOURS, Line2D, directory, distinct, grid, lines_below, number, numbers, plt, read, save, where

TORQUE, SPRING = "constant torque, R/2", "EPSD, R*"


def ordered(rows, column):
    return sorted(rows, key=lambda row: number(row[column]))


def draw(folder):
    rows, friction = read(folder, "study.csv"), read(folder, "friction.csv")
    gaps = distinct(rows, "gap")
    colours = {gap: COLOURS[k % len(COLOURS)] for k, gap in enumerate(gaps)}
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.8, 5.2), width_ratios=(1.5, 1), sharey=True)
    for gap, colour in colours.items():
        mine = ordered(where(rows, gap=gap, rolling=TORQUE), "mu_r")
        spring = ordered(where(rows, gap=gap, rolling=SPRING), "mu_r")
        if gap in (gaps[0], gaps[-1]):
            left.plot(numbers(mine, "mu_r"), numbers(mine, "static_limit"), ":", color=colour, lw=1)
        left.plot(numbers(spring, "mu_r"), numbers(spring, "critical_mass"), "--", color=colour, lw=0.9, marker="s", ms=3.5,
                  mfc="white")
        left.plot(numbers(mine, "mu_r"), numbers(mine, "critical_mass"), "-", color=colour, lw=1.4, marker="o", ms=4)
        left.annotate(f"gap {number(gap):.2f} R", (number(mine[-1]["mu_r"]), number(mine[-1]["critical_mass"])),
                      xytext=(7, 0), textcoords="offset points", va="center", color=colour, fontsize=9)
        of = ordered(where(friction, gap=gap), "mu")
        right.plot(numbers(of, "mu"), numbers(of, "critical_mass"), "-", color=colour, lw=1.4, marker="o", ms=4)
        if gap in (gaps[0], gaps[-1]):
            right.plot(numbers(of, "mu"), numbers(of, "static_limit"), ":", color=colour, lw=1)
        right.axhline(number(of[0].get("required") or of[0].get("demanded")), color=colour, lw=5, alpha=0.22, zorder=0)
    used = number(rows[0]["mu"])
    right.axvline(used, color="0.6", lw=0.9, zorder=0)
    right.annotate(rf"$\mu = {used:g}$", (used, right.get_ylim()[1]), xytext=(-4, -5), textcoords="offset points",
                   ha="right", va="top", color="0.35", fontsize=9)
    left.set(xlabel=r"rolling resistance $\mu_r$", ylabel=r"critical mass of the upper sphere $m_{\mathrm{top}}^c$ [kg]",
             xlim=(0.05, 0.46), ylim=(0, None))
    left.set_title(rf"rolling resistance varied, $\mu = {used:g}$", fontsize=11)
    right.set_xlabel(r"friction coefficient $\mu$")
    right.set_title(r"friction varied, no rolling ($\mu_r = 0.4$)", fontsize=11)
    for axes in (left, right):
        grid(axes)
    handles = [Line2D([], [], color="0.3", marker="o", ms=4, label=r"constant torque, $\mu_r N R/2$ at every contact"),
               Line2D([], [], color="0.3", ls="--", lw=0.9, marker="s", ms=3.5, mfc="white",
                      label=r"spring and dashpot, $\mu_r N R^*$ ($R$ on the ground)"),
               Line2D([], [], color="0.3", ls=":", lw=1, label="static equilibrium, first and last gap"),
               Line2D([], [], color="0.5", lw=5, alpha=0.35, label="plateaus of the dissertation")]
    save(figure, folder, "granular-stacking.png", below=lines_below(figure, handles, 4), top=1)


draw(directory())
