#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Change of the floor forces caused by a force on a lattice of spheres.                  Fang (2022), Figs. 7.9, 7.10

    granular-waves.py DIR     reads DIR/study.csv and DIR/profiles.csv, writes DIR/granular-waves.png
"""
from drawing import COLOURS, Line2D, MARKERS, directory, distinct, grid, lines_below, number, numbers, plt, read, save, where

NAMES = {"scaled": r"$F_n = k_n\sqrt{\delta/R}\,\delta$" "\n" r"$k_n = 30000\,mg/R$",
         "linear": r"$F_n = k_n\,\delta$" "\n" r"$k_n = 3000\,mg/R$"}


def draw(folder):
    rows, profiles = read(folder, "study.csv"), read(folder, "profiles.csv")
    laws, frictions, forces = (distinct(rows, column) for column in ("stiffness", "mu", "F"))
    shades = plt.get_cmap("viridis")
    colours = {F: shades(0.85 * k / max(1, len(forces) - 1)) for k, F in enumerate(forces)}
    figure, axes = plt.subplots(len(laws), len(frictions) + 1, figsize=(11, 3.4 * len(laws)), squeeze=False)
    low = min(numbers(profiles, "share"))
    high = max(numbers(profiles, "share"))
    for of_law, law in zip(axes, laws):
        for axis, mu in zip(of_law, frictions):
            for F in forces:
                mine = where(profiles, stiffness=law, mu=mu, F=F)
                axis.plot(numbers(mine, "position"), numbers(mine, "share"), "-", color=colours[F], lw=1.1, marker=".", ms=3)
            axis.set(xlim=(-30, 30), ylim=(low - 0.01, high + 0.01))
            axis.axhline(0, color="0.7", lw=0.8, zorder=0)
            if law == laws[0]:
                axis.set_title(rf"$\mu = {number(mu):g}$", fontsize=11)
            if law == laws[-1]:
                axis.set_xlabel("position [diameters]")
            grid(axis)
        of_law[0].set_ylabel(NAMES[law] + "\n\n" r"$\Delta F/F_{\mathrm{ext}}$")
        last = of_law[-1]
        for k, mu in enumerate(frictions):
            mine = where(rows, stiffness=law, mu=mu)
            last.semilogx(numbers(mine, "F"), numbers(mine, "centre"), "-", color=COLOURS[k], marker=MARKERS[k], ms=4.5,
                          lw=1.3, label=rf"$\mu = {number(mu):g}$")
        last.axhline(0, color="0.7", lw=0.8, zorder=0)
        last.set_xticks([float(F) for F in forces], [f"{number(F):g}" for F in forces], minor=False)
        last.minorticks_off()
        last.set_ylim(-0.045, 0.085)
        if law == laws[0]:
            last.legend(frameon=False, fontsize=9, loc="best")
            last.set_title("floor force below the load", fontsize=11)
        if law == laws[-1]:
            last.set_xlabel(r"$F_{\mathrm{ext}}/mg$")
        grid(last)
    handles = [Line2D([], [], color=colours[F], lw=1.5, marker=".", label=rf"$F_{{\mathrm{{ext}}}} = {number(F):g}\,mg$")
               for F in forces]
    save(figure, folder, "granular-waves.png", below=lines_below(figure, handles, len(forces)), top=1)


draw(directory())
