#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Final state of a sphere pushed up an incline over slope and rolling resistance.              Fang (2022), Fig. 4.13

    incline-sweep.py DIR    reads DIR/study.csv and DIR/study.json, writes DIR/incline-sweep.png

Lines: limits from the Coulomb bounds (A.7), with mu_s = 0.25 and mu_k = 0.2.
"""
import math

from drawing import Line2D, directory, lines_below, number, plt, read, record, save
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

MU_S, MU_K = 0.25, 0.2
STATES = ["rest", "pure rolling", "rolling with slip", "slip without rolling"]
COLOURS = ["#b5cde8", "#fdf2cf", "#f6c28b", "#c78b8b"]


def degrees(tangent):
    return math.degrees(math.atan(tangent))


def draw(folder):
    rows = read(folder, "study.csv")
    study = record(folder)
    etas = sorted({number(row["eta_r"]) for row in rows})
    angles = sorted({number(row["angle_deg"]) for row in rows})
    place = {(number(row["eta_r"]), number(row["angle_deg"])): row for row in rows}
    states = [[int(place[e, a]["state"]) for e in etas] for a in angles]
    figure, axes = plt.subplots(figsize=(8.8, 6.4))
    axes.pcolormesh(etas, angles, states, cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=3.5, shading="nearest", rasterized=True)
    low, high = axes.get_xlim()
    eta = [low + (high - low) * k / 400 for k in range(401)]
    axes.plot(eta, [degrees(min(2 * e * MU_K, MU_S)) for e in eta], "-", color="k", lw=1.4)
    axes.plot(eta, [degrees(2 * e * MU_S) for e in eta], ":", color="k", lw=1.2)
    axes.plot(eta, [degrees(3.5 * MU_S - 5 * e * MU_K) for e in eta], "--", color="k", lw=1.4)
    axes.plot(eta, [degrees(max(3.5 * MU_K - 5 * e * MU_K, MU_K)) for e in eta], "--", color="0.45", lw=1)
    if high > 0.5:
        axes.plot([0.5, 0.5], [degrees(3.5 * MU_S - 2.5 * MU_K), angles[-1]], "-.", color="k", lw=1.4)
    differ = [row for row in rows if row["published"] and row["published"] != row["state"]]
    few = len(differ) <= 100
    if few:
        axes.plot([number(row["eta_r"]) for row in differ], [number(row["angle_deg"]) for row in differ], "x", color="#d1001f", ms=4)
    else:
        other = [[float(bool(place[e, a]["published"]) and place[e, a]["published"] != place[e, a]["state"]) for e in etas]
                 for a in angles]
        axes.contourf(etas, angles, other, levels=[0.5, 1.5], colors="none", hatches=["..."])
    axes.set_xlim(low, high)
    axes.set_ylim(angles[0], angles[-1])
    axes.set_xlabel(r"rolling resistance $\eta_r$")
    axes.set_ylabel(r"slope $\alpha$ [deg]")
    handles = [Patch(color=colour, label=label) for colour, label in zip(COLOURS, STATES)] + [
        Line2D([], [], color="k", ls="-", label=r"$\tan\alpha = 2\eta_r\mu_k$"),
        Line2D([], [], color="k", ls="--", label=r"$\tan\alpha = \frac{7}{2}\mu_s - 5\eta_r\mu_k$"),
        Line2D([], [], color="0.45", ls="--", lw=1, label=r"the same with $\mu_k$: slip can persist above"),
        Line2D([], [], color="k", ls="-.", label=r"$\eta_r = 1/2$"),
        Line2D([], [], color="k", ls=":", label=r"A.7 as published: $\tan\alpha = 2\eta_r\mu_s$")]
    if any(row["published"] for row in rows):
        label = f"published state differs: {len(differ)} of {len(rows)}"
        handles.append(Line2D([], [], color="#d1001f", ls="", marker="x", ms=5, label=label) if few else
                       Patch(fill=False, hatch="...", lw=0, label=label))
    axes.set_title(f"State {study['end']:g} s after a start with 0.5 m/s up the slope: {study['preset']} friction, "
                   f"{len(etas)} x {len(angles)} runs", fontsize=11)
    save(figure, folder, "incline-sweep.png", below=lines_below(figure, handles, 3), top=1)


draw(directory())
