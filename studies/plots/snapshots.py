#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Models at several times: bodies, joints, and the paths of bodies and contact points.              Fang (2022), Fig. 3.3

    snapshots.py DIR     reads DIR/poses.csv, DIR/contacts.csv and DIR/shapes.json, writes DIR/snapshots-PROBLEM.png
"""
from bodies import PATH, Scene, colour_of, common_box, legend, panels, runs
from drawing import directory, save

MOST_NAMES = 8


def look(low, high):
    """Elevation and azimuth of the viewer [deg], who faces the longer one of the two horizontal directions, or both if they
    are similar, and looks down on a flat motion"""
    x, y, z = high - low
    return 22 if z > 0.25 * min(x, y) else 50, -72 if y < 0.35 * x else -18 if x < 0.35 * y else -50


def draw(folder, run):
    times = run.times()
    low, high = common_box([(run, t) for t in times])
    figure, axes = panels(len(times), 2, 4.2, 3.5)
    for ax, t in zip(axes, times):
        scene = Scene(ax, run, t, low, high, look(low, high))
        scene.surroundings()
        scene.paths(of_contacts=len(run.contacts) <= MOST_NAMES)
        scene.bodies()
        scene.joints()
        scene.contacts(0)
        scene.finish(f"$t$ = {t:.4g} s")
    entries = [(body, colour_of(k), "-") for k, body in enumerate(run.bodies)][:MOST_NAMES]
    if 0 < len(run.contacts) <= MOST_NAMES:
        entries.append(("path of the contact point", PATH, "-"))
    title = f"{run.name}: bodies, joints, and paths of the centres of mass"
    if len(run.bodies) > MOST_NAMES:
        title = f"{run.name}: {len(run.bodies)} bodies ({MOST_NAMES} of them named), and paths of the centres of mass"
    figure.suptitle(title, fontsize=11)
    save(figure, folder, f"snapshots-{run.name}.png", legend(figure, entries), 0.96)


folder = directory()
for one in runs(folder).values():
    draw(folder, one)
