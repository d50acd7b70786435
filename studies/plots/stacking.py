#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Critical mass of a stack of three spheres over the rolling resistance.                      Fang (2022), Fig. 4.19

    stacking.py DIR     reads DIR/study.csv and DIR/study.json, writes DIR/stacking.png; from DIR/poses.csv and the files
                        beside it DIR/stacking-snapshots.png
"""
import bodies
from drawing import COLOURS, Line2D, directory, distinct, grid, number, numbers, plt, read, record, save, where

MODES = {"rolling": "o", "both": "D", "sliding": "s", "-": "x"}


def draw(folder):
    rows = read(folder, "study.csv")
    study = record(folder)
    compared = any(row["published"] for row in rows)
    column = "collapse_mode" if "collapse_mode" in rows[0] else "gives_way"  # name in results of earlier versions
    figure, axes = plt.subplots(figsize=(8.6, 6.2))
    for k, gap in enumerate(distinct(rows, "gap")):
        mine, colour = where(rows, gap=gap), COLOURS[k % len(COLOURS)]
        eta, mass = numbers(mine, "eta_r"), numbers(mine, "critical_mass")
        if compared:
            axes.plot(eta, numbers(mine, "published"), "-", color=colour, lw=5, alpha=0.22, zorder=1)
        axes.plot(eta, mass, "-", color=colour, lw=1.3)
        for mode, marker in MODES.items():
            those = [(e, m) for e, m, row in zip(eta, mass, mine) if row[column] == mode]
            axes.plot([e for e, _ in those], [m for _, m in those], marker, color=colour, ms=4.5, mew=1,
                      mfc="white" if mode == "rolling" else colour)
        axes.annotate(f"gap {number(gap):.2f} R", (eta[-1], mass[-1]), xytext=(0, 5), textcoords="offset points",
                      ha="right", color=colour, fontsize=9)
    axes.set_xlabel(r"rolling resistance $\eta_r$")
    axes.set_ylabel(r"critical mass of the upper sphere $m_{\mathrm{top}}^c$ [kg]")
    grid(axes)
    handles = [Line2D([], [], color="0.3", ls="", marker=MODES[mode], mfc="white" if mode == "rolling" else "0.3", ms=5,
                      label=label)
               for mode, label in (("rolling", "lower spheres roll"), ("both", "lower spheres roll and slide"),
                                   ("sliding", "lower spheres slide")) if where(rows, **{column: mode})]
    if compared:
        handles.append(Line2D([], [], color="0.5", lw=5, alpha=0.35, label="published"))
    axes.legend(handles=handles, loc="lower right", bbox_to_anchor=(1, 0.01), frameon=True, framealpha=0.9, fontsize=9)
    axes.set_title(f"Critical mass of the upper sphere: {study['preset']} friction, h = {study['h']:g} s", fontsize=11)
    save(figure, folder, "stacking.png", top=1)


def snapshots(folder):
    """Stacks that stand (left) and collapse under 0.01 kg more (right), with their outlines at the start"""
    runs, study = bodies.runs(folder), record(folder)
    low, high = bodies.common_box([(run, t) for run in runs.values() for t in run.times()], 0.05)
    figure, axes = bodies.panels(len(runs), 2, 4.2, 2.7)
    for ax, of in zip(axes, study["snapshots"]):
        run = runs[of["run"]]
        scene = bodies.Scene(ax, run, of["t"], low, high, (8, -90))
        scene.surroundings()
        scene.outline(0, colors="0.45", linewidths=0.8, linestyles="dashed")
        scene.bodies()
        scene.body_frames(0.8 * bodies.size_of(run, "top"), ("left", "right", "top"))
        scene.contacts(0)
        saturated = [what for what in ("roll", "slide") if of[what + "_saturates"]]
        state = (" and ".join(saturated) + " friction at the bound") if of["collapses"] else "stands"
        scene.finish(f"({of['run']}) $\\eta_r$ = {of['eta_r']:g}, top {of['top_mass']:.3f} kg, $t$ = {of['t']:.3g} s\n{state}")
        ax.set_yticks([])
        ax.set_ylabel("")
    gap = study["snapshots"][0]["gap"]
    figure.suptitle(f"Three stacked spheres (Fig. 4.19 b-g), gap {gap:.2f} R, {study['preset']} friction", fontsize=11)
    entries = [("body frames", bodies.BODY_FRAME, "-"), ("outlines at the start", "0.45", "--")]
    save(figure, folder, "stacking-snapshots.png", bodies.legend(figure, entries), 0.96)


draw(directory())
if record(directory()).get("snapshots"):
    snapshots(directory())
