#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Single wheel with prescribed slip on a bed of grains.                                        Fang (2022), Sec. 7.2.6

    granular-wheel.py DIR     reads DIR/study.csv, DIR/motion.csv and DIR/grains.csv, writes DIR/granular-wheel.png
"""
from drawing import COLOURS, directory, distinct, grid, number, numbers, plt, read, save, wheel_on_grains, where

OMEGA = 0.2967  # [rad/s]
RADIUS, GRAIN = 0.13, 7.5e-3  # of the cylinder and of the grains [m]
QUANTITIES = [("pull", 1, "drawbar pull [N]"), ("torque", 1, "driving torque [N m]"), ("sinkage", 1000, "sinkage [mm]")]


def over_slip(axes, rows, column, factor, label):
    lines = [(wheel, mu_r) for wheel in distinct(rows, "wheel") for mu_r in distinct(where(rows, wheel=wheel), "mu_r")]
    for k, (wheel, mu_r) in enumerate(lines):
        mine = sorted(where(rows, wheel=wheel, mu_r=mu_r), key=lambda row: number(row["slip"]))
        axes.errorbar(numbers(mine, "slip"), [factor * x for x in numbers(mine, column)],
                      yerr=[factor * x for x in numbers(mine, column + "_deviation")], fmt="osD^v"[k] + ("--" if k == 1 else "-"),
                      color=COLOURS[k], ms=5, lw=1.3, capsize=2, elinewidth=0.7, label=rf"{wheel}, $\mu_r$ = {number(mu_r):g}")
    axes.axhline(0, color="0.6", lw=0.8)
    axes.set(xlabel="slip", ylabel=label)


def draw(folder):
    rows, motion, grains = (read(folder, name) for name in ("study.csv", "motion.csv", "grains.csv"))
    figure, panels = plt.subplots(3, 3, figsize=(13, 10.5), height_ratios=[1.25, 1, 0.8])
    for axes, (column, factor, label) in zip(panels[0], QUANTITIES):
        over_slip(axes, rows, column, factor, label)
    rough = sorted(where(rows, wheel=rows[0]["wheel"], mu_r=rows[0]["mu_r"]), key=lambda row: number(row["slip"]))
    chosen = [row for row in rough if number(row["slip"]) in (-0.3, 0, 0.3, 0.7)]
    for axes, (column, factor, label) in zip(panels[1], QUANTITIES):
        for k, row in enumerate(chosen):
            mine = where(motion, wheel=row["wheel"], slip=row["slip"], mu_r=row["mu_r"])
            axes.plot(numbers(mine, "t"), [factor * x for x in numbers(mine, column)], "-", color=COLOURS[k], lw=1,
                      label=f"slip {number(row['slip']):g}")
        axes.axvline(max(numbers(motion, "t")) / 2, color="0.6", lw=0.8, ls=":")
        axes.set(xlabel="time [s]", ylabel=label)
    for axes, row in zip(panels[2], [row for row in chosen if number(row["slip"]) != 0]):
        mine = where(grains, wheel=row["wheel"], slip=row["slip"], mu_r=row["mu_r"])
        drawn = wheel_on_grains(axes, mine, GRAIN, RADIUS, ("wheel_x", "wheel_z"), OMEGA * RADIUS)
        axes.set(xlim=(0, 700), ylim=(0, 280), title=f"slip {number(row['slip']):g}")
    panels[2][0].set_ylabel("z [mm]")
    bar = figure.colorbar(drawn, cax=panels[2][2].inset_axes([1.03, 0, 0.04, 1]))
    bar.set_label(r"speed over $\omega$ radius")
    for axes in panels[:2].flat:
        grid(axes)
        axes.legend(frameon=False, fontsize=8)
    save(figure, folder, "granular-wheel.png", top=1)


draw(directory())
