#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Speed and spin after an oblique impact over the angle.                                        Fang (2022), Fig. 7.6

    granular-oblique.py DIR     reads DIR/study.csv, DIR/reference.csv and DIR/levers.csv, writes DIR/granular-oblique.png
"""
from drawing import COLOURS, Line2D, directory, grid, lines_below, number, numbers, plt, read, save, where

LAWS = {"mindlin": ("o", COLOURS[0], "force from the total displacement (Eq. 2.45)"),
        "mindlin-incremental": ("s", COLOURS[1], "force by increments (Eq. 2.44)")}


def draw(folder):
    rows, reference = read(folder, "study.csv"), read(folder, "reference.csv")
    sliding = sorted(where(reference, law="sliding"), key=lambda row: number(row["from_normal"]))
    critical = number(sliding[0]["from_normal"])
    figure, both = plt.subplots(1, 2, figsize=(10.8, 4.8))
    for axes, column in zip(both, ("e_t", "omega")):
        for law, (marker, colour, _) in LAWS.items():
            curve, mine = where(reference, law=law), where(rows, law=law)
            stride = -(-len(mine) // 30)  # at most 30 points
            mine = mine[stride - 1::stride]
            below = [row for row in curve if number(row["from_normal"]) <= critical]
            axes.plot(numbers(below, "from_normal"), numbers(below, column), "--", color=colour, lw=0.9)
            axes.plot(numbers(mine, "from_normal"), numbers(mine, column), marker, color=colour, ms=5.5 if marker == "o" else 8,
                      mfc=colour if marker == "o" else "none", ls="")
        axes.plot(numbers(sliding, "from_normal"), numbers(sliding, column), "-", color="k", lw=1.4, zorder=3)
        axes.axvline(critical, color="0.7", lw=0.9, zorder=0)
        axes.set(xlabel=r"angle of impact from the normal $\theta$ [deg]", xlim=(0, 90))
        axes.secondary_xaxis("top", functions=(lambda a: 90 - a, lambda a: 90 - a)).set_xlabel(
            "angle of impact from the wall [deg]", fontsize=9)
        grid(axes)
    short = [row for row in where(read(folder, "levers.csv"), lever="contact") if number(row["E"]) == 2e5]
    both[1].plot(numbers(short, "from_normal"), numbers(short, "omega"), "x", color=COLOURS[2], ms=7, zorder=4)
    both[0].set_ylabel(r"tangential restitution $e_t$")
    both[0].axhline(5 / 7, color="0.5", ls=":", lw=1)
    both[0].annotate("5/7: rigid, sticking", (2, 5 / 7), xytext=(0, 3), textcoords="offset points", color="0.4", fontsize=9)
    both[0].annotate(r"$\theta = \arctan\,\frac{7}{2}\mu(1+e)$", (critical, 1.0), xytext=(-4, 0), textcoords="offset points",
                     ha="right", va="top", color="0.4", fontsize=9)
    both[1].set_ylabel(r"spin after the impact $\omega$ [rad/s]")
    handles = [Line2D([], [], color="k", lw=1.4, label="sliding during the whole impact, Eqs. 7.2, 7.3")] + [
        Line2D([], [], color=colour, ls="--", lw=0.9, marker=marker, mfc=colour if marker == "o" else "none", label=label)
        for marker, colour, label in LAWS.values()] + [
        Line2D([], [], color=COLOURS[2], ls="", marker="x", ms=7, label=r"sliding, lever arm $R - \delta/2$, $\delta_m = 0.054 R$")]
    save(figure, folder, "granular-oblique.png", below=lines_below(figure, handles, 2), top=1)


draw(directory())
