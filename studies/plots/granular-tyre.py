#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Single-wheel rig with a tyre on a bed of grains, in co-simulation.                   Fang (2022), Figs. 7.20, 7.25

    granular-tyre.py DIR     reads DIR/study.csv, DIR/motion.csv and DIR/grains.csv, writes DIR/granular-tyre.png
"""
from drawing import COLOURS, directory, grid, number, numbers, plt, read, save, wheel_on_grains, where

RADIUS, GRAIN, OMEGA = 0.13, 7.5e-3, 1  # of the tyre and of the grains [m], [rad/s]
QUANTITIES = [("pull", 1, "drawbar pull [N]"), ("torque", 1, "driving torque [N m]"), ("sinkage", 1000, "sinkage [mm]")]


def over_slip(axes, rows, column, factor, label):
    imposed = sorted(where(rows, imposed="1"), key=lambda row: number(row["slip"]))
    for k, rough in enumerate((True, False)):
        mine = [row for row in imposed if (number(row["mu_r"]) > 0) == rough]
        axes.plot(numbers(mine, "slip"), [factor * x for x in numbers(mine, column)], "os"[k] + ("-" if rough else "--"),
                  color=COLOURS[k], ms=5, lw=1.3, label="imposed slip" + ("" if rough else r", $\mu_r$ = 0"))
        with_error = [row for row in mine if row.get(column + "_error", "")]
        axes.errorbar(numbers(with_error, "slip"), [factor * x for x in numbers(with_error, column)],
                      [factor * x for x in numbers(with_error, column + "_error")], ls="", color=COLOURS[k], lw=1, capsize=3)
    free = where(rows, imposed="0")
    axes.plot(numbers(free, "slip"), [factor * x for x in numbers(free, column)], "*", color=COLOURS[2], ms=11,
              label="free slip under torque")
    axes.axhline(0, color="0.6", lw=0.8)
    axes.set(xlabel="slip", ylabel=label)


def name(row):
    return f"slip {number(row['slip']):.2g}" + ("" if row["imposed"] == "1" else " (free)")


def draw(folder):
    rows, motion, grains = (read(folder, table) for table in ("study.csv", "motion.csv", "grains.csv"))
    figure, panels = plt.subplots(3, 3, figsize=(13, 10.5), height_ratios=[1.25, 1, 0.8])
    for axes, (column, factor, label) in zip(panels[0], QUANTITIES):
        over_slip(axes, rows, column, factor, label)
    rough = [row for row in rows if number(row["mu_r"]) > 0]
    chosen = sorted((row for row in rough if row["imposed"] == "0" or abs(number(row["slip"])) < 0.65),
                    key=lambda row: number(row["slip"]))
    of = lambda table, row: where(table, slip=row["slip"], mu_r=row["mu_r"])
    for axes, (column, factor, label) in zip(panels[1], QUANTITIES):
        for k, row in enumerate(chosen):
            mine = of(motion, row)
            axes.plot(numbers(mine, "t"), [factor * x for x in numbers(mine, column)], "-", color=COLOURS[k % len(COLOURS)],
                      lw=1, label=name(row))
        axes.set(xlabel="time [s]", ylabel=label)
    shown = [chosen[0], next(row for row in chosen if row["imposed"] == "0"), chosen[-1]]
    for axes, row in zip(panels[2], shown):
        drawn = wheel_on_grains(axes, of(grains, row), GRAIN, RADIUS, ("tyre_x", "tyre_z"), OMEGA * RADIUS)
        axes.set(xlim=(0, 600), ylim=(0, 330), title=name(row))
    panels[2][0].set_ylabel("z [mm]")
    bar = figure.colorbar(drawn, cax=panels[2][2].inset_axes([1.03, 0, 0.04, 1]))
    bar.set_label(r"speed over $\omega$ radius")
    for axes in panels[:2].flat:
        grid(axes)
    for axes in (*panels[0], panels[1][2]):
        axes.legend(frameon=False, fontsize=8)
    save(figure, folder, "granular-tyre.png", top=1)


draw(directory())
