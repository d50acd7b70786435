#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Restitution of a head-on collision over integrator and step.                                 Fang (2022), Fig. 7.2

    granular-head-on.py DIR     reads DIR/study.csv, refinement.csv and clamped.csv, writes DIR/granular-head-on.png
"""
from drawing import COLOURS, Line2D, directory, distinct, grid, lines_below, numbers, plt, read, save, where

# symplectic Euler and velocity Verlet give the same results; their markers are nested
STYLES = {"symplectic-euler": (COLOURS[0], "o", 4.5, COLOURS[0]), "velocity-verlet": (COLOURS[5], "o", 9, "none"),
          "chung": (COLOURS[2], "D", 5, COLOURS[2]), "extended-taylor": (COLOURS[4], "^", 6, COLOURS[4]),
          "forward-euler": (COLOURS[1], "s", 5.5, COLOURS[1])}


def points(scheme, line):
    colour, marker, size, face = STYLES[scheme]
    return {"color": colour, "marker": marker, "ms": size, "mfc": face, "ls": line, "lw": 0.9}


def draw_rebound(axes, rows, clamped):
    mine, measured = where(rows, integrator="symplectic-euler"), points("symplectic-euler", "")
    axes.plot([0, 1.05], [0, 1.05], "-", color="0.35", lw=1.2, label=r"$|v_\mathrm{end}/v_i| =$ COR")
    axes.plot(numbers(mine, "restitution"), numbers(mine, "rebound"), label="symplectic-euler", **measured | {"ms": 6})
    axes.plot(numbers(clamped, "restitution"), numbers(clamped, "rebound"), "x", color="0.35", ms=6,
              label="the same, tensile\nforce set to zero")
    axes.legend(loc="upper left", frameon=False, fontsize=9)
    axes.set(xlabel="coefficient of restitution COR", ylabel=r"rebound $|v_\mathrm{end}/v_i|$", xlim=(0, 1.05), ylim=(0, 1.05))


def draw_differences(axes, rows, schemes):
    for scheme in schemes:
        mine = where(rows, integrator=scheme)
        axes.semilogy(numbers(mine, "restitution"), [abs(d) for d in numbers(mine, "difference")], **points(scheme, "-"))
    axes.set(xlabel="coefficient of restitution COR", ylabel=r"difference $\left|\,|v_\mathrm{end}/v_i| - \mathrm{COR}\,\right|$",
             xlim=(0, 1.05), ylim=(2e-9, 2e-2))
    axes.text(0.03, 0.03, "$h$ = 3e-5 s", transform=axes.transAxes, fontsize=9)


def draw_refinement(axes, rows, schemes):
    for scheme in schemes:
        mine = where(rows, integrator=scheme)
        axes.loglog(numbers(mine, "h"), numbers(mine, "worst_double"), "-", color=STYLES[scheme][0], lw=0.9)
        axes.loglog(numbers(mine, "h"), numbers(mine, "worst"), **points(scheme, ""))
    h, top = [3e-5, 1e-6], 2.2 * max(numbers(rows, "worst_double"))
    axes.loglog(h, [top, top * h[1] / h[0]], "--", color="0.6", lw=1, zorder=0)
    axes.set(xlabel="step $h$ [s]", ylabel="largest difference over all COR\nand contact times within a step")
    axes.legend(handles=[Line2D([], [], color="0.35", ls="", marker="o", ms=5, label="integer positions"),
                         Line2D([], [], color="0.35", lw=1, label="double precision"),
                         Line2D([], [], color="0.6", ls="--", lw=1, label="slope 1")],
                loc="lower right", frameon=False, fontsize=9)


def draw(folder):
    rows = read(folder, "study.csv")
    schemes = distinct(rows, "integrator")
    figure, axes = plt.subplots(1, 3, figsize=(11, 4.4))
    draw_rebound(axes[0], rows, read(folder, "clamped.csv"))
    draw_differences(axes[1], rows, schemes)
    draw_refinement(axes[2], read(folder, "refinement.csv"), schemes)
    for ax in axes:
        grid(ax)
    handles = [Line2D([], [], label=scheme, **points(scheme, "-")) for scheme in schemes]
    save(figure, folder, "granular-head-on.png", below=lines_below(figure, handles, 5), top=1)


draw(directory())
