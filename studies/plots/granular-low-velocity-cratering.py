#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Impact of a sphere on a bed of beads at low velocity.                                        Fang (2022), Sec. 7.2.4

    granular-low-velocity-cratering.py DIR     reads DIR/study.csv and DIR/motion.csv, writes
                                               DIR/granular-low-velocity-cratering.png
"""
from drawing import COLOURS, directory, distinct, grid, number, numbers, plt, read, save, where

EARTH = 5  # a larger gravity is that of the earth [m/s²]
QUANTITIES = [("depth", 100, "depth [cm]"), ("time", 1000, "collision time [ms]"), ("peak", 1, "peak acceleration [m/s²]")]


def on_earth(rows, earth=True):
    return [row for row in rows if (number(row["g"]) > EARTH) == earth]


def of_highest_bed(rows):
    """The rows of the bed that most impacts have: the others are those of the study of its height"""
    heights = [row["height"] for row in rows]
    return where(rows, height=max(distinct(rows, "height"), key=heights.count)) if rows else []


def over_speed(axes, rows, column, factor, label):
    for k, mu_r in enumerate(distinct(rows, "mu_r")):
        mine = sorted(where(rows, mu_r=mu_r), key=lambda row: number(row["speed"]))
        axes.plot(numbers(mine, "speed"), [factor * x for x in numbers(mine, column)], "o-", color=COLOURS[k], ms=5, lw=1.2,
                  label=rf"$\mu_r$ = {number(mu_r):g}")
        published = [row for row in mine if row[column + "_published"]]
        axes.plot(numbers(published, "speed"), [factor * x for x in numbers(published, column + "_published")], "s",
                  color=COLOURS[k], mfc="none", ms=7)
    axes.plot([], [], "s", color="0.35", mfc="none", ms=7, label="published")
    axes.set(xlabel="impact speed [m/s]", ylabel=label, xlim=(0, None), ylim=(0, None))


def over_time(axes, motion, rows, column, factor, name):
    for k, row in enumerate(rows):
        mine = where(motion, **{key: row[key] for key in ("mu_r", "speed", "g", "height", "x")})
        axes.plot([1000 * t for t in numbers(mine, "t")], [factor * x for x in numbers(mine, column)], "-", color=COLOURS[k],
                  lw=1.1, label=name(row))
    axes.set(xlabel="time after the first contact [ms]")


def draw(folder):
    rows, motion = read(folder, "study.csv"), read(folder, "motion.csv")
    earth, low = of_highest_bed(on_earth(rows)), on_earth(rows, earth=False)
    heights = [row for row in on_earth(rows) if row["mu_r"] == "0.09" and row["speed"] == "1.03"]
    more = len(distinct(heights, "height")) > 1
    figure, panels = plt.subplots(3 if more else 2, 3, figsize=(12, 11 if more else 7.5))

    for axes, (column, factor, label) in zip(panels[0], QUANTITIES):
        over_speed(axes, earth, column, factor, label)
    depth, acceleration, reduced = panels[1]
    chosen = [row for row in earth if row["mu_r"] in ("0", "0.09") and row["speed"] in ("0.51", "1.03")]
    over_time(depth, motion, chosen, "depth", -100, lambda row: rf"$\mu_r$ = {row['mu_r']}, {row['speed']} m/s")
    depth.set(ylabel="lowest point of the sphere [cm]")
    over_time(acceleration, motion, [row for row in chosen if row["mu_r"] == "0.09"], "a_filtered", 1,
              lambda row: f"{row['speed']} m/s")
    acceleration.set(ylabel="filtered acceleration [m/s²]", title=r"$\mu_r$ = 0.09", xlim=(-5, 60))
    over_time(reduced, motion, low, "depth", -100, lambda row: f"{row['speed']} m/s")
    reduced.set(ylabel="lowest point of the sphere [cm]", title="g = 0.1 m/s²")
    if more:
        for axes, (column, factor, label) in zip(panels[2], QUANTITIES):
            mine = sorted(heights, key=lambda row: number(row["height"]))
            axes.plot([100 * h for h in numbers(mine, "height")], [factor * x for x in numbers(mine, column)], "o-",
                      color=COLOURS[0], ms=5, label="earth, 1.03 m/s")
            axes.set(xlabel="height of the bed [cm]", ylabel=label, ylim=(0, None))
    for axes in panels.flat:
        grid(axes)
        axes.legend(frameon=False, fontsize=8)
    save(figure, folder, "granular-low-velocity-cratering.png", top=1)


draw(directory())
