# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshots: bodies in space at some times, drawn from the tables PREFIXposes.csv, PREFIXcontacts.csv and PREFIXshapes.json
of a study (run/frames/tables.hpp).

The panels have equal scales on their axes and an orthographic projection. The polygons of all bodies are drawn from the
farthest to the nearest one; those that face away from the viewer are not drawn.
"""
import json
import os

import numpy as np
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from drawing import COLOURS, Line2D, lines_below, numbers, plt, read

BODY_FRAME, CONTACT_FRAME, VELOCITY, FRICTION, PATH = "#d62728", "#2ca02c", "#1f4fd8", "#d020d0", "0.15"
LIGHT = np.array([0.3, -0.45, 0.84])
SMOOTH = 50  # a mesh with more polygons is a round surface: two tones in turn show its orientation, and no edges


def vectors(rows, *columns):
    return np.array([numbers(rows, column) for column in columns]).T.reshape(-1, len(columns))


class Samples:
    """Rows of one body or contact: columns as arrays, by time"""

    def __init__(self, rows, **groups):
        self.t = np.array(numbers(rows, "t"))
        self.shown = np.array(numbers(rows, "shown")) == 1
        for name, columns in groups.items():
            setattr(self, name, vectors(rows, *columns))

    def at(self, t):
        """The row of the time t; None if there is none"""
        k = int(np.argmin(np.abs(self.t - t)))
        return k if abs(self.t[k] - t) <= 1e-9 * (1 + abs(t)) else None


class Run:
    """The snapshots of one run. `turn`: a rotation matrix that is applied to everything that is drawn."""

    def __init__(self, shapes, poses, contacts, turn=None):
        self.name, self.bodies = shapes["run"], shapes["bodies"]
        self.joints, self.lines = shapes["joints"], shapes["lines"]
        self.meshes = [mesh | {"points": np.array(mesh["points"]).reshape(-1, 3)} for mesh in shapes["meshes"]]
        self.poses = {body: Samples(rows, r=("rx", "ry", "rz"), v=("vx", "vy", "vz"),
                                    A=[f"A{i}{j}" for i in "123" for j in "123"]) for body, rows in poses.items()}
        self.contacts = {name: Samples(rows, C=("Cx", "Cy", "Cz"), u=("ux", "uy", "uz"), N=("Nx", "Ny", "Nz"),
                                       F=("Fx", "Fy", "Fz")) for name, rows in contacts.items()}
        self.turn = np.eye(3) if turn is None else np.array(turn)

    def times(self):
        first = next(iter(self.poses.values()))
        return list(first.t[first.shown])

    def pose(self, body, t):
        """Position and rotation matrix of a body by number; -1: ground"""
        if body < 0:
            return np.zeros(3), np.eye(3)
        of = self.poses[self.bodies[body]]
        k = of.at(t)
        return of.r[k], of.A[k].reshape(3, 3)

    def placed(self, body, points, t):
        r, A = self.pose(body, t)
        return r + np.asarray(points) @ A.T

    def box(self, t):
        """Lowest and highest coordinates of the bodies, without unbounded surfaces"""
        points = [self.placed(mesh["body"], mesh["points"], t) for mesh in self.meshes if not mesh["unbounded"]]
        points += [self.placed(line["body_" + end], [line["point_" + end]], t)
                   for line in self.lines if line["kind"] != "link" for end in "ij"]
        every = np.vstack(points)
        return every.min(axis=0), every.max(axis=0)


def runs(folder, prefix="", turn=None):
    """The runs of a result directory, by name"""
    poses, contacts = {}, {}
    for table, key, of in (("poses.csv", "body", poses), ("contacts.csv", "contact", contacts)):
        if os.path.exists(os.path.join(folder, prefix + table)):
            for row in read(folder, prefix + table):
                of.setdefault(row["run"], {}).setdefault(row[key], []).append(row)
    with open(os.path.join(folder, prefix + "shapes.json"), encoding="utf-8") as file:
        return {shapes["run"]: Run(shapes, poses[shapes["run"]], contacts.get(shapes["run"], {}), turn)
                for shapes in json.load(file)}


def normal(polygon):
    """Of a polygon, by Newell's method; zero for a degenerate one"""
    n = np.cross(polygon, np.roll(polygon, -1, axis=0)).sum(axis=0)
    length = np.linalg.norm(n)
    return n / length if length > 0 else n


def colour_of(body):
    return COLOURS[body % len(COLOURS)] if body >= 0 else "0.8"


def shade(colour, brightness):
    return tuple(np.clip(np.array(plt.matplotlib.colors.to_rgb(colour)) * brightness, 0, 1))


class Scene:
    """A panel with the bodies of a run at the time t. `look`: elevation and azimuth of the viewer [deg]; `low`, `high`: the
    box of the bodies over all panels of the figure, before the turn of the run."""

    def __init__(self, axes, run, t, low, high, look, zoom=1.2):
        self.axes, self.run, self.t, self.low, self.high = axes, run, t, low, high
        axes.computed_zorder = False
        axes.set_proj_type("ortho")
        axes.view_init(*look)
        elevation, azimuth = np.radians(look)
        self.to_viewer = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth),
                                   np.sin(elevation)])
        corners = np.array([[(low, high)[k][0], (low, high)[l][1], (low, high)[m][2]]
                            for k in (0, 1) for l in (0, 1) for m in (0, 1)]) @ run.turn.T
        lowest, highest = corners.min(axis=0), corners.max(axis=0)
        size = highest - lowest
        # a tall or wide box stays in the panel, with the label of the vertical axis on its right
        width = abs(size[0] * np.sin(azimuth)) + abs(size[1] * np.cos(azimuth))
        axes.set_box_aspect(size, zoom=min(zoom, 0.8 * np.linalg.norm(size) / size[2], 0.88 * np.linalg.norm(size) / width))
        axes.patch.set_visible(False)  # it would cover labels of the panel beside
        for set_limits, a, b in zip((axes.set_xlim3d, axes.set_ylim3d, axes.set_zlim3d), lowest, highest):
            set_limits(a, b, auto=False)

    def place(self, body, points):
        return self.run.placed(body, points, self.t) @ self.run.turn.T

    def polygons(self):
        """Polygons that face the viewer, their colours and edge colours"""
        polygons, faces, edges = [], [], []
        for mesh in self.run.meshes:
            if mesh["unbounded"]:
                continue
            points, colour = self.place(mesh["body"], mesh["points"]), colour_of(mesh["body"])
            smooth, centre = len(mesh["polygons"]) > SMOOTH, mesh["points"].mean(axis=0)
            for polygon in mesh["polygons"]:
                n = normal(points[polygon])
                if n @ self.to_viewer <= 0:
                    continue
                bright = 0.75 + 0.35 * max(0.0, n @ LIGHT)
                if smooth and mesh["body"] >= 0 and np.prod(np.sign(mesh["points"][polygon].mean(axis=0) - centre)) < 0:
                    bright += 0.5
                polygons.append(points[polygon])
                faces.append(shade(colour, bright))
                edges.append(faces[-1] if smooth else shade(colour, 0.65 * bright))
        return polygons, faces, edges

    def bodies(self):
        polygons, faces, edges = self.polygons()
        if polygons:
            self.axes.add_collection3d(Poly3DCollection(polygons, facecolors=faces, edgecolors=edges, linewidths=0.3,
                                                        zsort="average", zorder=4))

    def surroundings(self):
        """The parts of unbounded surfaces; a flat one is drawn over the width of the box of the bodies."""
        for mesh in self.run.meshes:
            if not mesh["unbounded"]:
                continue
            points = self.run.placed(mesh["body"], mesh["points"], self.t)
            if np.ptp(points[:, 2]) <= 1e-9 * np.ptp(points):
                part = (points - points.min(axis=0))[:, :2] / np.ptp(points[:, :2], axis=0)
                points[:, :2] = self.low[:2] + part * (self.high - self.low)[:2]
            points = points @ self.run.turn.T
            self.axes.add_collection3d(Poly3DCollection([points[p] for p in mesh["polygons"]], facecolors="0.9",
                                                        edgecolors="0.83", linewidths=0.3, zorder=1))

    def inside(self, points):
        return np.all((points >= self.low - 1e-9) & (points <= self.high + 1e-9))

    def joints(self):
        """Joints, springs, bars and links. A link, which has no mass, is drawn if it stays within the box of the bodies."""
        places = [self.run.placed(joint["body"], [joint["point"]], self.t) for joint in self.run.joints]
        for place in places:
            if self.inside(place):
                self.axes.plot(*(place @ self.run.turn.T).T, "o", ms=3.2, mfc="white", mec="black", mew=0.8, zorder=6)
        for line in self.run.lines:
            ends = np.vstack([self.run.placed(line["body_" + end], [line["point_" + end]], self.t) for end in "ij"])
            if line["kind"] == "link" and not self.inside(ends):
                continue
            style = {"spring": dict(ls="--", color="0.3", lw=1.2), "link": dict(ls=":", color="0.3", lw=1)}.get(
                line["kind"], dict(ls="-", color=colour_of(line["body_i"]), lw=3))
            self.axes.plot(*(ends @ self.run.turn.T).T, zorder=5, solid_capstyle="round", **style)

    def outline(self, t, **style):
        """The outlines of the bodies at another time"""
        now, self.t = self.t, t
        segments = []
        for mesh in self.run.meshes:
            if mesh["unbounded"]:
                continue
            points, facing = self.place(mesh["body"], mesh["points"]), {}
            for polygon in mesh["polygons"]:
                front = normal(points[polygon]) @ self.to_viewer > 0
                for a, b in zip(polygon, polygon[1:] + polygon[:1]):
                    facing.setdefault((min(a, b), max(a, b)), set()).add(front)
            segments += [points[list(edge)] for edge, sides in facing.items() if len(sides) == 2]
        self.t = now
        if segments:
            self.axes.add_collection3d(Line3DCollection(segments, zorder=3, **style))

    def paths(self, of_bodies=True, of_contacts=True):
        """The paths of the bodies and of the contact points until the time of the panel"""
        if of_bodies:
            for k, body in enumerate(self.run.bodies):
                of = self.run.poses[body]
                r = of.r[of.t <= self.t + 1e-12] @ self.run.turn.T
                self.axes.plot(*r.T, "-", color=colour_of(k), lw=0.9, zorder=2)
        for of in self.run.contacts.values() if of_contacts else ():
            C = of.C[of.t <= self.t + 1e-12] @ self.run.turn.T
            self.axes.plot(*C.T, "-", color=PATH, lw=1.2, zorder=2)

    def arrow(self, origin, vector, colour, width=1.5):
        """An arrow, not turned"""
        if np.linalg.norm(vector) > 0:
            self.axes.quiver(*(self.run.turn @ origin), *(self.run.turn @ vector), color=colour, lw=width,
                             arrow_length_ratio=0.16, zorder=7)

    def body_frames(self, length, bodies=None):
        for k, body in enumerate(self.run.bodies):
            if bodies is None or body in bodies:
                r, A = self.run.pose(k, self.t)
                for axis in A.T:
                    self.arrow(r, length * axis, BODY_FRAME)

    def contacts(self, length, friction=0.0):
        """The contact frames (u, w, n), and the friction forces with a length of `friction` [m/N]"""
        for of in self.run.contacts.values():
            k = of.at(self.t)
            if k is None:
                continue
            n = of.N[k] / np.linalg.norm(of.N[k])
            if np.any(of.u[k]):
                for axis in (of.u[k], np.cross(n, of.u[k]), n):
                    self.arrow(of.C[k], length * axis, CONTACT_FRAME)
            if friction:
                self.arrow(of.C[k], friction * of.F[k], FRICTION, 2)
            self.axes.plot(*(of.C[k] @ self.run.turn.T)[:, None], "o", ms=3, color="black", zorder=8)

    def velocity(self, body, scale):
        """The velocity of the centre of mass, with a length of `scale` [s]"""
        of = self.run.poses[body]
        k = of.at(self.t)
        self.arrow(of.r[k], scale * of.v[k], VELOCITY, 2)

    def finish(self, title, labels=("$x$ [m]", "$y$ [m]", "$z$ [m]"), ticks=3):
        axes = self.axes
        axes.set_title(title, fontsize=9, y=0.97)
        size = [np.ptp(axis.get_view_interval()) for axis in (axes.xaxis, axes.yaxis, axes.zaxis)]
        for axis, set_label, label, length in zip((axes.xaxis, axes.yaxis, axes.zaxis),
                                                  (axes.set_xlabel, axes.set_ylabel, axes.set_zlabel), labels, size):
            is_short = length < 0.35 * max(size)
            set_label(label, fontsize=8, labelpad=-6 if is_short else -4)
            axis.set_major_locator(MaxNLocator(1 if is_short else ticks, min_n_ticks=1))
            axis.set_pane_color((1, 1, 1, 0))
            axis._axinfo["grid"].update(color=(0.93, 0.93, 0.93, 1))
        axes.tick_params(labelsize=7, pad=-2)


def common_box(all_runs_and_times, margin=0.08):
    """The box of the bodies of (run, t), with a margin relative to its largest side. On a floor the lower side has none."""
    boxes = [run.box(t) for run, t in all_runs_and_times]
    low, high = np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)
    room = margin * (high - low).max()
    on_floor = any(mesh["unbounded"] for run, _ in all_runs_and_times for mesh in run.meshes)
    low = low - room * np.array([1, 1, 0 if on_floor else 1])
    return low, high + room


def size_of(run, body):
    """Half the largest side of the meshes of a body [m]"""
    points = np.vstack([mesh["points"] for mesh in run.meshes if run.bodies[mesh["body"]] == body])
    return np.ptp(points, axis=0).max() / 2


def panels(count, columns, width=3.1, height=2.9, rows_extra=0.7):
    """A figure with 3-D panels"""
    rows = -(-count // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(width * columns, height * rows + rows_extra), squeeze=False,
                                subplot_kw={"projection": "3d"})
    for empty in axes.flat[count:]:
        empty.remove()
    return figure, list(axes.flat[:count])


def legend(figure, entries):
    """A legend of coloured lines below the figure; returns its height as a fraction of the figure height"""
    handles = [Line2D([], [], color=colour, lw=2, ls=dash, label=label) for label, colour, dash in entries]
    return lines_below(figure, handles, 5) + 0.15 / figure.get_figheight()
