#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Friction experiments, one figure per experiment, and snapshots of some.         Fang (2022), Figs. 4.6-4.12, 4.14-4.18

    friction.py DIR       reads DIR/study.csv and DIR/EXPERIMENT.csv, writes DIR/friction-EXPERIMENT.png; from
                          DIR/EXPERIMENT-poses.csv and the files beside it DIR/friction-EXPERIMENT-snapshots.png
"""
import math
import os

import bodies
from drawing import COLOURS, DASHES, Line2D, axis, directory, lines_below, number, numbers, plt, read, save

# EXPERIMENT: rows of panels; a panel is (column, label, limits of t or None)
PANELS = {
    "brick": [[("x", "$x$ [m]", None), ("v", "$v$ [m/s]", None)],
              [("Ef", "$E_f$ [N]", None), ("Df", "$D_f$ [N]", None)],
              [("S", "$S_{ij}$ [m]", None), ("dS", r"$\Delta S_{ij}$ [m]", None)]],
    "disk": [[("x", "$x$ [m]", (0, 1.6)), ("theta", r"$\theta$ [rad]", (0, 1.6))],
             [("v", "$v$ [m/s]", (0, 1.6)), ("omega", r"$\omega$ [rad/s]", (0, 1.6))],
             [("F_E", "$F_E$ [N]", (0, 1.6)), ("T_E", "$T_E$ [N m]", (0, 1.6))],
             [("S_mm", "$S$ [mm]", (0, 1.6)), ("Theta_e-3rad", r"$\Theta$ [mrad]", (0, 1.6))]],
    "disk-damping": [[("a", "$\\ddot x$ [m/s²]", (1.22, 1.42)), ("alpha", r"$\ddot\theta$ [rad/s²]", (1.22, 1.42))]],
    "rolling-models": [[("theta", r"$\theta$ [rad]", None), ("T_E", "rolling torque [N m]", None)],
                       [("theta", r"$\theta$ [rad], at rest", (1.25, 1.5)),
                        ("T_E", "rolling torque [N m], at rest", (1.25, 1.5))]],
    "incline": [[("v_cm", "$v_{CM}$ [m/s]", None), ("omega_x", r"$\omega$ [rad/s]", None)],
                [("F_E", "$F_E$ [N]", None), ("T_E", "$T_E$ [N m]", None)]],
    "spin": [[("omega", r"$\omega$ [rad/s]", None), ("T", "spinning torque [N m]", None)]],
    "ellipsoid": [[("tilt", "tilt [deg]", None), ("omega", r"$\omega$ [rad/s]", None)],
                  [("y", "$y$ [m]", None), ("z", "$z$ [m]", None)]],
}
PANELS["brick-angles"] = PANELS["brick"]
PRESETS = ("dissertation", "balanced")


def split(run):
    """Preset and remainder of a run name: ("balanced", "eta0.012") for balanced-eta0.012, ("", run) without preset"""
    preset, _, rest = run.partition("-")
    return (preset, rest) if preset in PRESETS else ("", run)


def styles(runs):
    """Colour by the varied parameter; dashes for the preset `dissertation` if both presets are present, otherwise by the
    parameter as well, so that the curves differ without colours"""
    varied = list(dict.fromkeys(split(run)[1] or split(run)[0] for run in runs))
    both = len({split(run)[0] for run in runs} - {""}) > 1 and any(split(run)[1] for run in runs)
    place = {run: varied.index(split(run)[1] or split(run)[0]) for run in runs}
    return {run: (COLOURS[place[run] % len(COLOURS)],
                  DASHES[split(run)[0] == "dissertation"] if both else DASHES[place[run] % len(DASHES)]) for run in runs}


def curve(rows, column):
    return numbers(rows, "t"), numbers(rows, column)


def below(figure, lines, columns=4):
    """Draws a legend below the figure and returns its height as a fraction of the figure height"""
    handles = [Line2D([], [], color=colour, ls=dash, label=label) for label, (colour, dash) in lines.items()]
    return lines_below(figure, handles, columns)


def within(rows, limits):
    return [row for row in rows if limits is None or limits[0] <= number(row["t"]) <= limits[1]]


def panels(folder, name, title, by_run):
    layout = PANELS[name]
    figure, axes = plt.subplots(len(layout), len(layout[0]), figsize=(10, 1.2 + 2.4 * len(layout)), squeeze=False)
    lines = styles(list(by_run))
    for row, row_axes in zip(layout, axes):
        for (column, label, limits), ax in zip(row, row_axes):
            for run, rows in by_run.items():
                colour, dash = lines[run]
                ax.plot(*curve(within(rows, limits), column), dash, color=colour, lw=1.2)
            axis(ax, "$t$ [s]", label)
    if name == "disk":  # the axis excludes the dashpot force of the first steps
        axes[2][0].set_ylim(-1, 14)
    figure.suptitle(title, fontsize=11)
    save(figure, folder, f"friction-{name}.png", below(figure, lines))


def spinning(folder, name, title, by_run, groups, columns):
    """A row of panels for each group of runs, coloured by K_E"""
    figure, axes = plt.subplots(len(groups), len(columns), figsize=(10, 1.2 + 2.4 * len(groups)), squeeze=False)
    stiffness = list(dict.fromkeys(run.rpartition("-")[2] for run in by_run))
    for group, row_axes in zip(groups, axes):
        for (column, label), ax in zip(columns, row_axes):
            for run, rows in by_run.items():
                preset, rest = split(run)
                if rest.rpartition("-")[0] != group:
                    continue
                ax.plot(*curve(rows, column), "--" if preset == "dissertation" else "-", lw=1.1,
                        color=COLOURS[stiffness.index(rest.rpartition("-")[2])])
            axis(ax, "$t$ [s]", label, group, 9)
    figure.suptitle(title, fontsize=11)
    lines = {"$K_E$ = " + s[2:] + " N/m": (COLOURS[k], "-") for k, s in enumerate(stiffness)}
    lines["preset dissertation (dashed)"] = ("0.4", "--")
    save(figure, folder, f"friction-{name}.png", below(figure, lines, columns=5))


def orbits(folder, name, title, by_run):
    figure, (plane, radius) = plt.subplots(1, 2, figsize=(10, 4.6))
    runs = [run for run in by_run if run.startswith("beta")]
    lines = {run.replace("beta=", r"$\beta$ = "): (COLOURS[k], "-") for k, run in enumerate(runs)}
    for (colour, _), run in zip(lines.values(), runs):
        rows = by_run[run]
        plane.plot(numbers(rows, "x"), numbers(rows, "y"), color=colour, lw=1)
        radius.plot(*curve(rows, "radius"), color=colour)
    plane.set_aspect("equal")
    axis(plane, "$x$ [m]", "$y$ [m]")
    axis(radius, "$t$ [s]", "radius relative to the exact one")
    figure.suptitle(title, fontsize=11)
    save(figure, folder, f"friction-{name}.png", below(figure, lines))


def draw(folder, name, figure):
    by_run = {}
    for row in read(folder, name + ".csv"):
        by_run.setdefault(row["run"], []).append(row)
    title = f"{name} (Fig. {figure})" if figure[0].isdigit() else name
    if name == "spin-hertz":
        spinning(folder, name, title, by_run, ["steel-20mm", "steel-40mm", "glass-20mm"],
                 [("Psi", r"$\Psi$ [rad]"), ("omega", r"$\omega$ [rad/s]")])
    elif name == "spin-ellipsoid":
        spinning(folder, name, title + ": inertia of the ellipsoid; dashed: inertia used in the published runs", by_run,
                 ["upright", "flat"], [("Psi", r"$\Psi$ [rad]"), ("omega", r"$\omega$ [rad/s]")])
    elif name == "turntable":
        orbits(folder, name, title + r": ten orbits of a ball for different spin corrections $\beta$", by_run)
    elif name in PANELS:
        columns = [panel[0] for row in PANELS[name] for panel in row]
        by_run = {run: rows for run, rows in by_run.items() if all(rows[0].get(c) for c in columns)}
        panels(folder, name, title, by_run)


ALONG_Y, OBLIQUE = (22, 12), (24, -50)  # elevation and azimuth of the viewer [deg]
SNAPSHOTS = {  # figure, columns, viewer, slope [deg], texts of the panels
    "incline": ("4.12 b-e", 2, ALONG_Y, 35,
                ["I: up the slope, slipping", "II: up, rolling", "III: down, rolling", "IV: down, slipping"]),
    "spin": ("4.14", 4, OBLIQUE, 0, ["start", "spinning", "spinning", "at rest"]),
    "ellipsoid": ("4.17", 3, ALONG_Y, 0, [""] * 6),
}


def rotation_about_x(angle_deg):
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return [[1, 0, 0], [0, c, -s], [0, s, c]]


def snapshots(folder, name):
    """The body of the run at the times of the dissertation, with its frame, the contact frame, its velocity, the friction
    force and the path of the contact point"""
    number_of_figure, columns, look, slope, texts = SNAPSHOTS[name]
    for run in bodies.runs(folder, name + "-", rotation_about_x(slope)).values():
        times, body = run.times(), run.bodies[0]
        size = bodies.size_of(run, body)
        low, high = bodies.common_box([(run, t) for t in times], 0.25)
        motion, contact = run.poses[body], run.contacts.get(body)
        touching = {t: contact.at(t) if contact else None for t in times}
        fastest = max(math.hypot(*motion.v[motion.at(t)]) for t in times)
        strongest = max((math.hypot(*contact.F[k]) for k in touching.values() if k is not None), default=0)
        moves, has_friction = fastest > 1e-6, strongest > 1e-6
        figure, axes = bodies.panels(len(times), columns, 3.1, 4.0 if slope else 2.9)
        for ax, t, text in zip(axes, times, texts):
            scene = bodies.Scene(ax, run, t, low, high, look, 1.05 if slope else 1.2)
            scene.surroundings()
            scene.paths(of_bodies=False)
            scene.bodies()
            scene.body_frames(1.25 * size, [body])
            scene.contacts(0.6 * size, 1.2 * size / strongest if has_friction else 0)
            if moves:
                scene.velocity(body, 1.5 * size / fastest)
            text = text or ("" if touching[t] is not None else "no contact")
            scene.finish(f"$t$ = {t:.4g} s" + (f"\n{text}" if text else ""), SLOPED if slope else AXES)
        entries = [("body frame", bodies.BODY_FRAME, "-"), ("contact frame $u$, $w$, $n$", bodies.CONTACT_FRAME, "-")]
        if moves:
            entries.append((f"velocity, longest {fastest:.3g} m/s", bodies.VELOCITY, "-"))
        if has_friction:
            entries.append((f"friction force, longest {strongest:.3g} N", bodies.FRICTION, "-"))
        if moves:
            entries.append(("path of the contact point", bodies.PATH, "-"))
        figure.suptitle(f"{name} (Fig. {number_of_figure}), run {run.name}", fontsize=11)
        save(figure, folder, f"friction-{name}-snapshots.png", bodies.legend(figure, entries), 0.96)


AXES = ("$x$ [m]", "$y$ [m]", "$z$ [m]")
SLOPED = ("$x$ [m]", "horizontal [m]", "vertical [m]")

FIGURES = {"brick": "4.6", "brick-angles": "4.7", "disk": "4.9", "disk-damping": "4.10", "rolling-models": "4.11",
           "incline": "4.12", "spin": "4.15", "spin-hertz": "4.16", "ellipsoid": "4.17", "spin-ellipsoid": "4.18",
           "turntable": "beyond"}

folder = directory()
for experiment in sorted(file[:-4] for file in os.listdir(folder) if file.endswith(".csv")):
    if experiment not in ("study", "against") and not experiment.endswith(("-poses", "-contacts")):
        draw(folder, experiment, FIGURES.get(experiment, "4"))
        if experiment in SNAPSHOTS and os.path.exists(os.path.join(folder, experiment + "-shapes.json")):
            snapshots(folder, experiment)
