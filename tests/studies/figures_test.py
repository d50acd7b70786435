#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts in studies/plots, on tables with known orders: which curves and panels a figure has, slope guides, hollow
markers, the caption, and tick labels that do not overlap.

    figures_test.py PLOTS       PLOTS: the folder studies/plots
"""
import contextlib
import csv
import io
import json
import math
import os
import runpy
import sys
import tempfile
import unittest

PLOTS = os.path.abspath(sys.argv.pop(1))
sys.path.insert(0, PLOTS)
try:
    import matplotlib
    matplotlib.use("Agg")
    import drawing
    import options
    import slopes
    import ticks
except ModuleNotFoundError as missing:
    print(f"not tested: {missing}")
    sys.exit(0)
plt = drawing.plt
drawing.RESOLUTION = 50  # faster; the layout is the same

SCHEMES = ["ida-like", "rA-full-1", "rA-full-1-exact", "rA-genalpha", "rA-half-1", "rA-half-1-kick", "rA-half-1-momentum",
           "rA-half-2", "rA-half-2-bdf2", "rA-rattle", "rA-rkmk-4", "rp-full-1"]
ORDER = {"rA-full-1": 1, "rA-full-1-exact": 1, "rA-half-1": 1, "rp-full-1": 1, "rA-rkmk-4": 4}
NORMS = ["r", "A", "v", "omega", "Q", "r_end", "A_end", "v_end", "omega_end", "observable"]
SHOWN = ["rA-full-1", "rA-half-1", "rA-half-2", "rA-half-1-kick", "rA-half-1-momentum", "rA-half-2-bdf2", "rA-rattle",
         "rA-rkmk-4"]


def write(folder, name, rows):
    with open(os.path.join(folder, name), "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]))
        table.writeheader()
        table.writerows(rows)


def convergence_table(folder, steps, joints=True, schemes=SCHEMES):
    """study.csv and study.json of errors h^order; those below 1e-12 are at rounding"""
    rows, series = [], []
    for k, scheme in enumerate(schemes):
        order = ORDER.get(scheme, 2)
        series.append({"problem": "p", "integrator": scheme, "declared_order": order, "declared_order_lambda": order})
        for h in steps:
            row = {"problem": "p", "integrator": scheme, "h": h, "observable_scalar": "bar.rz", "status": "ok"}
            for norm in NORMS:
                error = (1 + 0.2 * k) * h ** order
                without = norm == "Q" and not joints
                row |= {norm: "" if without else error, "floor_" + norm: "" if without else int(error < 1e-12)}
            rows.append(row)
    write(folder, "study.csv", rows)
    with open(os.path.join(folder, "study.json"), "w", encoding="utf-8") as file:
        json.dump({"study": "convergence", "selection": "selected", "series": series}, file)


def draw(script, folder, *arguments):
    """Runs a script and returns its figures by file name, not closed"""
    figures = {}
    save = save_of_drawing

    def keep(figure, place, name, *more, **other):
        save(figure, place, name, *more, **other)
        figures[name] = figure
    options.arguments = options.Arguments([folder, *arguments])
    options.used.clear()
    options.leave_out([])
    options.in_legend.clear()
    drawing.save, drawing.plt.close = keep, lambda figure: None
    try:
        with contextlib.redirect_stdout(io.StringIO()) as out:
            runpy.run_path(os.path.join(PLOTS, script))
    finally:
        drawing.save, drawing.plt.close = save_of_drawing, close_of_matplotlib
    return figures, out.getvalue().split()


save_of_drawing, close_of_matplotlib = drawing.save, plt.close


def labels_of(axis):
    """Boxes of the tick labels that are visible"""
    low, high = sorted(axis.get_view_interval())
    renderer = axis.axes.figure.canvas.get_renderer()
    return [label.get_window_extent(renderer) for tick, label in zip(axis.get_majorticklocs(), axis.get_majorticklabels())
            if low <= tick <= high and label.get_text() and label.get_visible()] + [
        label.get_window_extent(renderer) for label in axis.get_minorticklabels() if label.get_text()]


def overlapping(axis):
    boxes = labels_of(axis)
    return [(a, b) for k, a in enumerate(boxes) for b in boxes[k + 1:] if a.overlaps(b)]


def legend_texts(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


class Figures(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = scratch.name

    def tearDown(self):
        plt.close("all")

    def check(self, figure):
        """No panel is empty and no labels overlap"""
        figure.canvas.draw()
        for axes in figure.axes:
            finite = [y for line in axes.lines for y in line.get_ydata() if math.isfinite(y)]
            self.assertTrue(finite, "a panel without a point")
            for axis in (axes.xaxis, axes.yaxis):
                self.assertFalse(overlapping(axis), axis.axis_name)
        for legend in figure.legends:
            box = legend.get_window_extent()
            self.assertGreaterEqual(box.x0, 0)
            self.assertLessEqual(box.x1, figure.bbox.width)

    def test_at_most_eight_curves_those_of_the_text_first_and_the_others_named_in_the_caption(self):
        convergence_table(self.folder, [4e-3, 2e-3, 1e-3])
        figures, files = draw("convergence.py", self.folder)
        figure = figures["convergence-p.png"]
        self.check(figure)
        self.assertEqual(files, ["convergence-p.png"])
        names = [text for text in legend_texts(figure) if text in SCHEMES]
        self.assertEqual(names[:3], SHOWN[:3])
        self.assertEqual(sorted(names), sorted(SHOWN))
        caption = " ".join(text.get_text() for text in figure.texts)
        for scheme in SCHEMES:
            self.assertEqual(scheme in caption.replace(",", " ").split(), scheme not in SHOWN, scheme)
        # on top: drawn later than all others
        order = {line.get_color(): line.get_zorder() for line in figure.axes[0].lines}
        of_text = [order[drawing.style(s)[0]] for s in SHOWN[:3]]
        self.assertGreater(min(of_text), max(order[drawing.style(s)[0]] for s in SHOWN[3:]))

    def test_named_integrators_and_quantities_are_shown_and_no_other(self):
        convergence_table(self.folder, [4e-3, 2e-3, 1e-3])
        figures, _ = draw("convergence.py", self.folder, "--integrator", "rp-full-1,rA-half-2", "--quantity", "v,Q")
        figure = figures["convergence-p.png"]
        self.check(figure)
        self.assertEqual([t for t in legend_texts(figure) if t in SCHEMES], ["rA-half-2", "rp-full-1"])
        self.assertEqual(len(figure.axes), 2)
        self.assertNotIn("not shown", " ".join(text.get_text() for text in figure.texts))

    def test_slope_guides_are_those_of_the_orders_in_the_figure(self):
        convergence_table(self.folder, [4e-3, 2e-3, 1e-3])
        for names, orders in (("rA-half-1,rA-half-2", {1, 2}), ("rA-rkmk-4", {4}), ("rA-half-1,rA-rkmk-4", {1, 4})):
            figures, _ = draw("convergence.py", self.folder, "--integrator", names, "--quantity", "r,Q")
            for axes in figures["convergence-p.png"].axes:
                texts = {text.get_text() for text in axes.texts}
                self.assertEqual(texts, {f"slope {k}" for k in orders}, names)
                # the guide has the slope that is written on it
                for line in axes.lines:
                    if line.get_color() == "0.5":
                        (x, y), (log_x, log_y) = line.get_data(), ([], [])
                        log_x, log_y = [math.log(v) for v in x], [math.log(v) for v in y]
                        slope = (log_y[-1] - log_y[0]) / (log_x[-1] - log_x[0])
                        self.assertAlmostEqual(min(abs(slope - k) for k in orders), 0, 9)

    def test_labels_of_slopes_overlap_neither_curves_nor_each_other(self):
        convergence_table(self.folder, [4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4])
        for names in ("rA-half-1,rA-half-2,rA-rkmk-4", "rA-full-1,rA-half-1,rA-genalpha,rA-rattle,rA-half-2,rA-rkmk-4"):
            figures, _ = draw("convergence.py", self.folder, "--integrator", names)
            figure = figures["convergence-p.png"]
            for axes in figure.axes:
                self.assertEqual(len(axes.texts), 3)
                boxes = [text.get_window_extent() for text in axes.texts]
                for k, box in enumerate(boxes):
                    self.assertFalse(any(box.overlaps(other) for other in boxes[k + 1:]))
                    self.assertTrue(axes.get_window_extent().containsx(box.x0) and axes.get_window_extent().containsx(box.x1))
                    self.assertTrue(axes.get_window_extent().containsy(box.y0) and axes.get_window_extent().containsy(box.y1))
                    for line in axes.lines:
                        for x, y, half in slopes.on_curve(axes, line):
                            self.assertFalse(box.x0 - half < x < box.x1 + half and box.y0 - half < y < box.y1 + half)

    def test_a_linear_axis_has_fewer_ticks_where_their_labels_would_be_crowded(self):
        for width, end in ((1.5, 0.04), (3, 0.04), (3, 1), (6, 123456)):
            figure, axes = plt.subplots(figsize=(width, 2))
            axes.plot([0, end], [0, 1])
            ticks.tidy(axes.xaxis)
            self.assertFalse(ticks.are_crowded(axes.xaxis), (width, end))
            low, high = axes.get_xlim()
            self.assertGreater(sum(low <= x <= high for x in axes.get_xticks()), 1)
            plt.close(figure)

    def test_points_at_rounding_are_hollow_and_the_others_are_not(self):
        convergence_table(self.folder, [4e-3, 2e-3, 1e-3, 5e-4, 2e-4])
        figures, _ = draw("convergence.py", self.folder, "--integrator", "rA-rkmk-4,rA-half-2", "--quantity",
                          "r,observable")
        for axes in figures["convergence-p.png"].axes:
            seen = set()
            for line in axes.lines:
                if line.get_marker() in ("None", "", None):
                    continue
                for y in line.get_ydata():
                    hollow = line.get_markerfacecolor() == "white"
                    self.assertEqual(hollow, y < 1e-12)
                    seen.add(hollow)
            self.assertEqual(seen, {True, False})

    def test_a_model_without_joints_has_no_panel_of_loads(self):
        convergence_table(self.folder, [4e-3, 2e-3, 1e-3], joints=False)
        figures, _ = draw("convergence.py", self.folder)
        figure = figures["convergence-p.png"]
        self.check(figure)
        self.assertEqual(len(figure.axes), len(NORMS) - 1)
        rows = [{"problem": "p", "integrator": s, "r": 1e-3 / k, "v": 1e-2 / k, "Q": "0", "cpu_seconds": 1e-3 * k, "end": 1,
                 "reference": "closed form", "status": "ok"} for s in ("rA-half-1", "rA-half-2") for k in (1, 2)]
        write(self.folder, "study.csv", rows)
        figures, _ = draw("work-precision.py", self.folder)
        self.assertEqual(len(figures["work-precision-p.png"].axes), 2)
        self.check(figures["work-precision-p.png"])

    def test_a_run_without_constraints_has_no_panel_of_residuals(self):
        rows = [{"t": 0.1 * k, "energy": 1 + k, "constraint_norm": 0} | {f"b.{q}{a}": k for q in "rw" for a in "xyz"}
                for k in range(5)]
        write(self.folder, "trajectory.csv", rows)
        figures, _ = draw("trajectory.py", self.folder)
        self.assertEqual(len(figures["trajectory.png"].axes), 3)
        self.check(figures["trajectory.png"])

    def test_a_granular_run_is_drawn_and_the_least_loaded_of_many_boundaries_are_named(self):
        rows = []
        for k in range(20):
            row = {"t": 0.01 * k, "kinetic_energy": 1e-3 / (1 + k), "contacts": k, "pairs": 2 * k}
            row |= {f"stress_{a}{b}": k * (a == b) for a in "xyz" for b in "xyz"}
            for n in range(10):
                row |= {f"wall{n}_{q}{a}": n * k for q in "FT" for a in "xyz"}
            rows.append(row)
        write(self.folder, "run.csv", rows)
        figures, files = draw("granular-run.py", self.folder, "--format", "png,pdf")
        self.assertEqual(files, ["run.png", "run.pdf"])
        self.check(figures["run.png"])
        self.assertEqual(len(figures["run.png"].axes), 5)
        self.assertEqual(legend_texts(figures["run.png"]), [f"wall{n}" for n in range(2, 10)])
        self.assertIn("not shown: wall1", " ".join(text.get_text() for text in figures["run.png"].texts))

    def granular_run(self):
        rows = []
        for k in range(20):
            row = {"t": 0.01 * k, "kinetic_energy": 1e-3 / (1 + k), "contacts": 0, "pairs": 0, "particles": 5 - k // 10,
                   "rotational_energy": 1e-4 / (1 + k), "potential_energy": 0.1 * k}
            row |= {f"momentum_{a}": k for a in "xyz"} | {f"stress_{a}{b}": 0 for a in "xyz" for b in "xyz"}
            row |= {f"lid_{q}{a}": k * (a == "z") for q in "FT" for a in "xyz"}
            row |= {f"lid_{q}{a}": 1 + k * (a == "z") for q in ("", "v", "w") for a in "xyz"}
            rows.append(row)
        write(self.folder, "run.csv", rows)

    def test_a_granular_run_has_panels_of_momentum_particles_and_the_motion_of_boundaries(self):
        self.granular_run()
        figures, _ = draw("granular-run.py", self.folder)
        self.check(figures["run.png"])
        # energy, potential energy, momentum, particles, force, torque, displacement, velocity, rotation
        self.assertEqual(len(figures["run.png"].axes), 9)
        displacement = figures["run.png"].axes[6]
        self.assertEqual([text.get_text() for text in displacement.get_legend().get_texts()], ["lid z"])
        self.assertEqual(list(displacement.lines[0].get_ydata()), list(range(20)))

    def test_a_granular_run_with_outflow_has_a_panel_of_the_mass_flow(self):
        self.granular_run()
        with open(os.path.join(self.folder, "run.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        write(self.folder, "run.csv", [row | {"removed_mass_rate": 0.1 * (k > 4)} for k, row in enumerate(rows)])
        figures, _ = draw("granular-run.py", self.folder, "--quantity", "flow")
        self.check(figures["run.png"])
        axes, = figures["run.png"].axes
        self.assertEqual([list(line.get_ydata()) for line in axes.lines], [[0] * 5 + [0.1] * 15])

    def test_fields_are_drawn_as_profiles_or_slices_and_mean_loads_with_bands(self):
        self.granular_run()
        names = ["density", "volume_fraction", *(f"{q}_{a}" for q in ("momentum", "velocity", "boundary_force") for a in "xyz"),
                 *(f"{q}_stress_{a}{b}" for q in ("kinetic", "contact") for a in "xyz" for b in "xyz")]

        def fields(name, nx, ny, nz):
            rows = [{"t": t, "x": x, "y": y, "z": z} | {n: 0 for n in names} |
                    {"density": 1000, "volume_fraction": 0.1 * z, "contact_stress_zz": nz - z, "kinetic_stress_zz": 1, "velocity_x": t}
                    for t in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6) for z in range(nz) for y in range(ny) for x in range(nx)]
            write(self.folder, f"fields-{name}.csv", rows)
        fields("profile", 1, 1, 8)
        fields("slice", 5, 1, 8)
        fields("solid", 5, 4, 8)
        loads = [{"t": 0.1 * k} | {f"lid_{q}{a}_{of}": k * (a == "z") for of in ("mean", "std") for q in "FT" for a in "xyz"}
                 for k in range(1, 5)]
        write(self.folder, "loads.csv", loads)
        figures, files = draw("granular-run.py", self.folder)
        self.assertEqual(files, ["run.png", "loads.png", "fields-profile.png", "fields-slice.png", "fields-solid.png"])
        for name in files[:3]:
            self.check(figures[name])
        for axes in figures["fields-slice.png"].axes:
            self.assertTrue(axes.collections and not overlapping(axes.xaxis), "a map with legible ticks")
        self.assertEqual(len(figures["loads.png"].axes), 2)  # Fz and Tz
        profile = figures["fields-profile.png"].axes
        self.assertEqual(len(profile), 4)  # volume fraction, velocity, normal stress, variance; no shear stress
        self.assertEqual(legend_texts(figures["fields-profile.png"]), [f"$t$ = {t} s" for t in (0.1, 0.3, 0.4, 0.6)])
        self.assertEqual(list(profile[2].lines[-1].get_xdata()), [9 - z for z in range(8)])  # kinetic and contact stress
        self.assertEqual(len(figures["fields-slice.png"].axes), 16)  # four quantities at four times
        self.assertEqual(figures["fields-solid.png"]._suptitle.get_text(), "slices at y = 2 m")
        figures, files = draw("granular-run.py", self.folder, "--quantity", "shear,volume_fraction")
        self.assertEqual(files, ["fields-profile.png", "fields-slice.png", "fields-solid.png"])

    def test_options_that_a_figure_cannot_use_and_unknown_names_are_refused(self):
        convergence_table(self.folder, [4e-3, 2e-3])
        for arguments, expected in ((["--integrator", "rA-half1"], "did you mean 'rA-half-1'?"),
                                    (["--quantity", "omegaa"], "did you mean 'omega'?")):
            with self.assertRaises(SystemExit) as ended, contextlib.redirect_stderr(io.StringIO()) as err:
                draw("convergence.py", self.folder, *arguments)
            self.assertEqual(ended.exception.code, 2)
            self.assertIn(expected, err.getvalue())
        write(self.folder, "trajectory.csv", [{"t": k, "energy": k, "constraint_norm": 0} for k in range(3)])
        with self.assertRaises(SystemExit) as ended, contextlib.redirect_stderr(io.StringIO()) as err:
            draw("trajectory.py", self.folder, "--integrator", "rA-half-1")
        self.assertEqual(ended.exception.code, 2)
        self.assertIn("--integrator is not an option", err.getvalue())

    def test_tick_labels_of_logarithmic_axes_do_not_overlap_whatever_the_range(self):
        for low, high in ((1e-3, 4e-3), (2e-4, 5e-4), (1e-3, 1.1e-3), (3e-7, 4e-7), (0.7, 0.9), (1, 99), (1e-5, 3e-4),
                          (1e-12, 1), (2.0, 2.0001), (5e4, 6e4), (1e-3, 1e-3)):
            for size in ((2, 1.6), (3.4, 2.8), (8, 6)):
                figure, axes = plt.subplots(figsize=size)
                axes.loglog([low, high], [low, high], "o")
                drawing.tidy_and_lay_out(figure, (0, 0, 1, 1))
                figure.canvas.draw()
                for axis in (axes.xaxis, axes.yaxis):
                    self.assertFalse(overlapping(axis), (low, high, size, axis.axis_name))
                    self.assertGreaterEqual(len(labels_of(axis)), 1, (low, high, size, axis.axis_name))
                plt.close(figure)


def pose(run, body, t, r, shown=1, turn=0.0):
    """A row of poses.csv: a body at r, turned by an angle about z"""
    c, s = math.cos(turn), math.sin(turn)
    A = {"A11": c, "A12": -s, "A13": 0, "A21": s, "A22": c, "A23": 0, "A31": 0, "A32": 0, "A33": 1}
    return {"run": run, "body": body, "t": t, "shown": shown, "rx": r[0], "ry": r[1], "rz": r[2], **A, "vx": 1, "vy": 0,
            "vz": 0}


def cube(body, half):
    points = [[x, y, z] for x in (-half, half) for y in (-half, half) for z in (-half, half)]
    polygons = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return {"body": body, "kind": "solid", "unbounded": False, "points": points, "polygons": polygons}


class SnapshotFigures(unittest.TestCase):
    """Two cubes on a floor; the first moves along x, the second stands behind it (y = 3)"""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.addCleanup(plt.close, "all")
        self.folder = scratch.name
        times = [0, 0.5, 1]
        write(self.folder, "poses.csv", [row for t in times for row in (
            pose("two", "near", t, (4 * t, 0, 0.5), int(t != 0.5), turn=t), pose("two", "far", t, (0, 3, 0.5), int(t != 0.5)))])
        floor = {"body": -1, "kind": "surface", "unbounded": True, "polygons": [[0, 1, 2, 3]],
                 "points": [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]}
        shapes = {"run": "two", "bodies": ["near", "far"], "meshes": [cube(0, 0.5), cube(1, 0.5), floor],
                  "joints": [{"body": 0, "point": [0, 0, 0.5]}, {"body": 1, "point": [0, 0, 70]}],
                  "lines": [{"kind": "link", "body_i": 0, "point_i": [0, 0, 0], "body_j": -1, "point_j": [0, 0, 70]}]}
        with open(os.path.join(self.folder, "shapes.json"), "w", encoding="utf-8") as file:
            json.dump([shapes], file)

    def test_panels_show_the_marked_times_with_equal_scales_around_all_bodies(self):
        figures, files = draw("snapshots.py", self.folder)
        self.assertEqual(files, ["snapshots-two.png"])
        figure = figures["snapshots-two.png"]
        self.assertEqual([axes.get_title() for axes in figure.axes], ["$t$ = 0 s", "$t$ = 1 s"])
        for axes in figure.axes:
            limits = [axes.get_xlim3d(), axes.get_ylim3d(), axes.get_zlim3d()]
            self.assertLess(limits[0][0], -0.5)
            self.assertGreater(limits[0][1], 4 + 0.5)
            self.assertGreater(limits[1][1], 3.5)
            self.assertAlmostEqual(limits[2][0], 0)  # the floor
            self.assertLess(limits[2][1], 3)         # not the end of the link, which has no mass
            aspect, sizes = axes._box_aspect, [high - low for low, high in limits]
            for k in (1, 2):
                self.assertAlmostEqual(aspect[k] / aspect[0], sizes[k] / sizes[0])
            self.assertEqual([axes.get_xlabel(), axes.get_ylabel(), axes.get_zlabel()],
                             ["$x$ [m]", "$y$ [m]", "$z$ [m]"])
        self.assertEqual(legend_texts(figure), ["near", "far"])

    def test_only_polygons_that_face_the_viewer_are_drawn_and_the_floor_is_below_them(self):
        import bodies
        run = bodies.runs(self.folder)["two"]
        _, (axes,) = bodies.panels(1, 1)
        low, high = bodies.common_box([(run, t) for t in run.times()])
        scene = bodies.Scene(axes, run, 1.0, low, high, (30, -60))
        polygons, faces, _ = scene.polygons()
        self.assertEqual(len(polygons), 6)  # three of each cube
        self.assertEqual(len(faces), 6)
        for polygon in polygons:
            centre = [4, 0, 0.5] if polygon[:, 1].mean() < 1.5 else [0, 3, 0.5]
            self.assertGreater((polygon.mean(axis=0) - centre) @ scene.to_viewer, 0)
        near = bodies.np.vstack(polygons[:3])
        self.assertAlmostEqual(bodies.np.abs(near[:, 0] - 4).max(), 0.5 * (math.cos(1) + math.sin(1)))  # turned by 1 rad
        scene.surroundings()
        scene.bodies()
        floor, solids = axes.collections
        self.assertLess(floor.get_zorder(), solids.get_zorder())

    def test_a_body_that_never_touches_has_snapshots_without_forces(self):
        for touches in (False, True):  # the contact has rows, but none at the times of the snapshots
            with tempfile.TemporaryDirectory() as folder:
                pose = dict(run="r", body="ball", rx=0, ry=0, rz=1, A11=1, A12=0, A13=0, A21=0, A22=1, A23=0, A31=0, A32=0,
                            A33=1, vx=0, vy=0, vz=-1)
                write(folder, "spin-poses.csv", [pose | {"t": t, "shown": 1} for t in (0, 1, 2, 3)])
                if touches:
                    vector = {name + axis: 1 for name in "CuNF" for axis in "xyz"}
                    write(folder, "spin-contacts.csv", [dict(run="r", contact="ball", t=0.5, shown=0) | vector])
                write(folder, "spin.csv", [{"run": "r", "t": t, "omega": 1, "T": 1} for t in (0, 3)])
                mesh = {"body": 0, "kind": "solid", "unbounded": False, "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
                        "polygons": [[0, 1, 2]]}
                with open(os.path.join(folder, "spin-shapes.json"), "w", encoding="utf-8") as file:
                    json.dump([{"run": "r", "bodies": ["ball"], "meshes": [mesh], "joints": [], "lines": []}], file)
                figures, _ = draw("friction.py", folder)
                figure = figures["friction-spin-snapshots.png"]
                self.assertFalse(any("friction force" in text for text in legend_texts(figure)))
                plt.close(figure)

    def test_the_outline_of_a_cube_has_its_six_silhouette_edges(self):
        import bodies
        run = bodies.runs(self.folder)["two"]
        _, (axes,) = bodies.panels(1, 1)
        low, high = bodies.common_box([(run, t) for t in run.times()])
        scene = bodies.Scene(axes, run, 1.0, low, high, (30, -60))
        scene.outline(0.0)
        self.assertEqual(len(axes.collections[0]._segments3d), 12)  # six of each cube
        self.assertEqual(scene.t, 1.0)


if __name__ == "__main__":
    unittest.main()
