#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Ball in an ellipsoidal bowl with the contact points as unknowns, one figure per scene.       Fang (2022), Figs. 5.2-5.6

    evolving-contact.py DIR     reads DIR/SCENE.csv, writes DIR/evolving-contact-SCENE.png
"""
import os

from drawing import COLOURS, DASHES, Line2D, axis, directory, distinct, lines_below, number, numbers, plt, read, save, where


def path(axes, rows, of, colour, dash, planar):
    across, up = (of + "_y", of + "_z") if planar else (of + "_x", of + "_y")
    axes.plot(numbers(rows, across), numbers(rows, up), dash, color=colour, lw=1)
    axis(axes, f"{across[-1]} [m]", f"{up[-1]} [m]")
    axes.set_aspect("equal", adjustable="datalim")


def draw(folder, scene, rows):
    planar = not scene.startswith("xy")
    figure, axes = plt.subplots(2, 3, figsize=(10.8, 6.8))
    lines = []
    for k, run in enumerate(distinct(rows, "run")):
        mine, colour, dash = where(rows, run=run), COLOURS[k % len(COLOURS)], DASHES[k % len(DASHES)]
        lines.append(Line2D([], [], color=colour, ls=dash, label=run))
        t = numbers(mine, "t")
        path(axes[0][0], mine, "aj", colour, dash, planar)
        path(axes[0][1], mine, "ai", colour, dash, planar)
        axes[0][2].plot(t, numbers(mine, "F_N"), dash, color=colour, lw=1)
        for ax, columns in ((axes[1][0], ("Psi", "N", "G")), (axes[1][1], ("lambda_N", "lambda_t"))):
            largest = [max(number(row[c]) for c in columns) for row in mine]
            ax.semilogy(t, [v if v > 0 else float("nan") for v in largest], dash, color=colour, lw=0.8)
        axes[1][2].plot(t, numbers(mine, "energy_change"), dash, color=colour, lw=1)
    titles = (r"contact point on the bowl $\bar\alpha_j$ [m]", r"contact point on the ball $\bar\alpha_i$ [m]",
              "normal force $F_N$ [N]", r"constraint residual, max of $\Psi$, $N$, $G$ [m]",
              r"max of $|\lambda_N|$ and tangential part of $\lambda_\Psi$ [N]",
              "change of energy $E - E_0$ [J]")
    for ax, title in zip(axes.flat, titles):
        axis(ax, title=title, size=9)
    for ax in (axes[0][2], *axes[1]):
        ax.set_xlabel("$t$ [s]")
    figure.suptitle(f"{scene}: ball in an ellipsoidal bowl, h = {number(rows[0]['h']):g} s", fontsize=11)
    below = lines_below(figure, lines)
    save(figure, folder, f"evolving-contact-{scene}.png", below)


def figures(folder):
    for scene in distinct(read(folder, "study.csv"), "scene"):
        if os.path.exists(os.path.join(folder, scene + ".csv")):
            draw(folder, scene, read(folder, scene + ".csv"))


figures(directory())
