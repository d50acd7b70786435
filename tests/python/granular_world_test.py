# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds of particles in Python: the states of the program, arrays, changes, refusals."""

import csv
import json
import os
import pathlib
import pickle
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import hilda_granular
from hilda_granular import InvalidInput, UsageError, World

PROGRAM = os.environ["HILDA_GRANULAR_PROGRAM"]
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples/cases"


def box(**keys):
    """60 particles above a floor."""
    return {"hilda_case": 1, "name": "box", "domain": {"low": [-0.01, -0.01, -0.005], "high": [0.03, 0.03, 0.06]},
            "step": 1e-5, "end": 0.01, "materials": [{"name": "glass", "density": 2500, "E": 1e7, "nu": 0.24}],
            "laws": [{"restitution": 0.5, "mu": 0.3, "tangential": {"law": "mindlin"}}],
            "boundaries": [{"name": "floor", "type": "plane", "normal": [0, 0, 1]},
                           {"name": "lid", "type": "sphere", "radius": 4e-3, "r": [0.01, 0.01, 0.05], "mass": 1e-3}],
            "fill": [{"type": "lattice", "low": [0, 0, 0], "high": [0.02, 0.02, 0.012], "radius": 1.9e-3, "spacing": 1.02}], **keys}


class States(unittest.TestCase):
    def check_as_program(self, case, *, steps=None, **settings):
        """All bits of the last state of hilda-granular and of a World that computes the same steps."""
        with tempfile.TemporaryDirectory() as folder:
            options = [f"--set={pointer}={json.dumps(value)}" for pointer, value in settings.items()]
            subprocess.run([PROGRAM, str(case), *options, "--contacts", "--no-vtk", "--quiet", "--output", folder + "/a"], check=True)
            with open(folder + "/a/particles.csv", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            with open(folder + "/a/contacts.csv", encoding="utf-8") as file:
                contacts = list(csv.DictReader(file))
            summary = json.loads(pathlib.Path(folder + "/a/summary.json").read_text())
        world = World(case, set=settings, threads=2)
        if steps is None:
            world.run()
        else:
            while world.step(steps) == steps and world.steps + steps <= round(world.end / world.h):
                pass
            world.step(round(world.end / world.h) - world.steps)
        self.assertEqual(world.steps, summary["counters"]["steps"])
        self.assertEqual(len(world), len(rows))
        names = {"id": world.id, "radius": world.radius}
        for name, array in (("", world.r), ("v", world.v), ("omega_", world.omega)):
            names.update({name + axis: array[:, k] for k, axis in enumerate("xyz")})
        for name, array in names.items():
            np.testing.assert_array_equal([float(row[name]) for row in rows], array, name)
        found = world.contacts()
        self.assertEqual(len(contacts), len(found.i))
        names = {"i": found.i, "j": found.j, "boundary": found.boundary, "overlap": found.delta}
        for name, array in (("n", found.n), ("F", found.F), ("u", found.u)):
            names.update({name + axis: array[:, k] for k, axis in enumerate("xyz")})
        for name, array in names.items():
            np.testing.assert_array_equal([float(row[name]) for row in contacts], array, name)
        self.assertEqual(world.totals().kinetic_energy, summary["kinetic_energy"])
        return world

    def test_a_bed(self):
        self.check_as_program("bed", **{"/end": 5e-3})
        self.check_as_program("bed", steps=170, **{"/end": 5e-3})

    def test_an_insertion_and_an_outflow(self):
        world = self.check_as_program("fed_hopper", **{"/end": 0.06})
        self.assertGreater(len(world), 0)

    def test_clumps_and_a_moving_wall(self):
        self.check_as_program(EXAMPLES / "clumps.json", **{"/end": 5e-3})
        self.check_as_program(EXAMPLES / "moving_wall.json", **{"/end": 0.12})

    def test_stages(self):
        stages = {"/end": 0.06, "/stages/0": {"name": "settle", "duration": 0.04, "until": {"share": 0.5, "from": 0.02}},
                  "/stages/1/duration": 0.01, "/stages/2/duration": 0.005}
        world = self.check_as_program("settle_push_load", **stages)
        self.assertEqual(world.stage, "load")
        self.assertLess(world.t, 0.06)  # the last stage is over
        self.assertEqual(world.step(5), 0)
        self.check_as_program("settle_push_load", steps=333, **stages)


class Particles(unittest.TestCase):
    def test_arrays(self):
        world = World(box())
        n = len(world)
        self.assertEqual((world.r.shape, world.v.shape, world.omega.shape), ((n, 3),) * 3)
        self.assertEqual((world.id.dtype, world.material.dtype, world.r.dtype), (np.uint32, np.int32, np.float64))
        self.assertEqual(world.materials, ["glass"])
        np.testing.assert_array_equal(world.id, np.arange(n))
        np.testing.assert_allclose(world.mass, 2500 * 4 / 3 * np.pi * world.radius**3, rtol=1e-6)
        self.assertFalse(world.fixed.any())
        self.assertTrue((world.clump == -1).all() and (world.group == -1).all() and (world.replica == 0).all())

    def test_arrays_are_read_only_and_remain_those_of_their_instant(self):
        world = World(box())
        r, v = world.r, world.v
        self.assertIs(world.r, r)
        with self.assertRaisesRegex(ValueError, "read-only"):
            r[0] = 0
        before = r.copy()
        world.step(10)
        np.testing.assert_array_equal(r, before)
        self.assertTrue((world.v[:, 2] < v[:, 2]).all())
        r = world.r
        del world
        self.assertTrue(np.isfinite(r).all())

    def test_orientations(self):
        world = World(box(orientation=True))
        world.step(10)
        np.testing.assert_allclose(np.linalg.norm(world.e, axis=1), 1, rtol=1e-12)
        with self.assertRaisesRegex(UsageError, "World.e: the case does not integrate orientations"):
            World(box()).e

    def test_velocities_and_forces(self):
        world = World(box(gravity=[0, 0, 0]))
        ids = world.id[::-2]
        v = np.random.default_rng(1).normal(size=(len(ids), 3))
        world.set_velocity(ids, v, [0, 0, 7])
        np.testing.assert_allclose(world.v[ids], v, rtol=0, atol=2e-9)  # a number of 32 bits and its remainder
        self.assertTrue((world.omega[ids] == [0, 0, 7]).all())
        world.set_velocity(ids, [0, 0, 0])
        self.assertTrue((world.v == 0).all())
        self.assertTrue((world.omega[ids] == [0, 0, 7]).all())
        world.set_force([3, 5], [[1e-3, 0, 0], [0, 2e-3, 0]])
        world.step(5)
        force = world.v[[3, 5]] * world.mass[[3, 5]][:, None] / world.t
        np.testing.assert_allclose(force, [[1e-3, 0, 0], [0, 2e-3, 0]], rtol=1e-4, atol=1e-9)

    def test_arrays_of_other_types_and_layouts(self):
        world = World(box())
        expected = np.array([[1, 0, 2], [3, 4, 5]])
        for v in (expected.tolist(), expected.astype(np.int32), np.asfortranarray(expected, dtype=np.float32),
                  np.repeat(expected, 2, axis=1)[:, ::2]):
            world.set_velocity(np.array([4, 9], dtype=np.int64), v)
            np.testing.assert_array_equal(world.v[[4, 9]], expected)

    def test_a_step_above_the_limit_of_added_particles_is_a_warning(self):
        world = World(box())
        before = list(world.warnings)
        world.add([0, 0, 0.03], 1e-3)
        self.assertEqual(world.warnings, before)
        world.add([0, 0, 0.04], 1e-3, mass=1e-12)
        self.assertRegex(world.warnings[-1], "World.add: the step .* s is above the stability limit .* with the particles that were added")

    def test_wrong_arrays(self):
        world = World(box())
        state = world.v
        for ids, v, text in (
                ([0, 1], np.zeros((3, 3)), r"World.set_velocity: v: must have the shape \(2, 3\) or \(3,\), got \(3, 3\)"),
                ([0], np.zeros(2), r"must have the shape \(1, 3\) or \(3,\), got \(2,\)"),
                ([0], [[1, np.nan, 0]], r"v: must be finite, got nan at index \[0, 1\]"),
                ([0], "abc", "must be an array of numbers, got str"),
                ([0], [1, 2j, 0], "must be an array of numbers, got list"),
                ([0], [[1, 2], [3]], "must be an array of numbers: "),
                ([0, 3, 0], [0, 0, 0], "World.set_velocity: an id is given twice, 0"),
                ([0.5], [0, 0, 0], r"World.set_velocity: ids must be whole numbers, got \[0.5\]"),
                ([-1], [0, 0, 0], "no particle has this id, got -1"),
                ([[0]], [0, 0, 0], r"ids must have the shape \(n,\), got \(1, 1\)"),
                ([0, 9999], [0, 0, 0], "velocity: no particle has this id, got 9999"),
                ([0], [1e39, 0, 0], "single precision")):
            with self.subTest(ids=ids, v=v):
                with self.assertRaisesRegex(InvalidInput, text) as raised:
                    world.set_velocity(ids, v)
                self.assertNotIn("\n", str(raised.exception))
        with self.assertRaisesRegex(InvalidInput, "force: no particle has this id, got 9999"):
            world.set_force(9999, [0, 0, 0])
        np.testing.assert_array_equal(world.v, state)

    def test_particles_are_added_and_removed(self):
        world = World(box())
        n = len(world)
        ids = world.add([[0.001, 0.001, 0.03], [0.02, 0.02, 0.03]], 1e-3, v=[0, 0, -1], material="glass")
        np.testing.assert_array_equal(ids, [n, n + 1])
        np.testing.assert_allclose(world.r[n:], [[0.001, 0.001, 0.03], [0.02, 0.02, 0.03]], atol=1e-12)
        self.assertTrue((world.v[n:] == [0, 0, -1]).all())
        world.step(10)
        world.remove(ids[0])
        self.assertEqual(len(world), n + 1)
        removed = world.take_removed()
        np.testing.assert_array_equal((removed.id, removed.side), ([n], [-1]))
        self.assertEqual(len(world.take_removed().id), 0)
        world.set_velocity(ids[1], [0, 0, 1])
        world.step(10)
        for call, text in ((lambda: world.remove(ids[0]), f"World.remove: no particle has this id, got {n}"),
                           (lambda: world.set_force(ids[0], [0, 0, 0]), f"no particle has this id, got {n}"),
                           (lambda: world.add([0, 0, 0.03], -1), "the radius must be positive, got -1"),
                           (lambda: world.add([0, 0, 1], 1e-3), r"World.add: r\[0\] must be inside the domain, got \(0, 0, 1\) m"),
                           (lambda: world.add([0, 0, 0.03], 1e-3, material="glas"), "no material 'glas'; the materials are glass"),
                           (lambda: world.add([0, 0, 0.03], 1e-3, group="a"), "the case has no group 'a'"),
                           (lambda: world.add([0, 0, 0.03], 1e-3, group=5), "group must be a name, got 5"),
                           (lambda: world.add([0, 0, 0.03], 1e-3, material=0.5), "number of the material must be a whole number from 0 to 0, got 0.5"),
                           (lambda: world.add([0, 0, 0.03], 1e-3, replica=1.5), "replica must be a whole number from 0 to 65535, got 1.5"),
                           (lambda: world.add(5, 1e-3), r"World.add: r: must have the shape \(1, 3\) or \(3,\), got \(\)"),
                           (lambda: world.add([[1, 2, 3], [1, 2]], 1e-3), "World.add: r: must be an array of numbers"),
                           (lambda: world.remove([[1], [1, 2]]), "World.remove: ids must be an array of whole numbers"),
                           (lambda: world.add([0, 0, 0.03], 1e-3, replica=-1), "replica must be a whole number from 0 to 65535, got -1"),
                           (lambda: world.add(np.zeros((2, 2)), 1e-3), r"r: must have the shape \(2, 3\)")):
            with self.subTest(text=text), self.assertRaisesRegex(InvalidInput, text):
                call()
        self.assertEqual(len(world), n + 1)
        world.step(10)

    def test_overlaps_of_new_particles(self):
        world, expected = World(box()), World(box())
        place, radius = world.r[0], world.radius[0]
        far, overlap = [0.025, 0.025, 0.03], r"World.add: r\[{}\] must not be that of a particle which overlaps .* 5 % of a radius, got \("
        for r, new_radius, index in (([place], 1e-3, 0),
                                     ([far, place + [0, 0, -radius]], 1e-3, 1),
                                     ([far, far, [0, 0, 0.03]], 1e-3, 1),  # each other
                                     ([[0.025, 0.025, 0.94e-3]], 1e-3, 0),  # the floor
                                     ([[0.025, 0.025, 0.003], [0.025, 0.025, 0.003 + 1.94e-3]], 1e-3, 1)):
            with self.subTest(r=r), self.assertRaisesRegex(InvalidInput, overlap.format(index)):
                world.add(r, new_radius)
        for of in (world, expected):  # the errors have changed nothing
            of.add([[0.025, 0.025, 0.96e-3], [0.025, 0.025, 0.96e-3 + 1.96e-3]], 1e-3)
            of.step(50)
        np.testing.assert_array_equal(world.r, expected.r)

    def test_overlaps_across_a_periodic_side(self):
        case = box(fill=[], particles=[{"r": [-0.0098, 0, 0.01], "radius": 1e-3}])
        case["domain"]["periodic"] = [True, False, False]
        world = World(case)
        with self.assertRaisesRegex(InvalidInput, "overlaps another one"):
            world.add([0.0298, 0, 0.01], 1e-3)
        world.add([0.028, 0, 0.01], 1e-3)
        self.assertEqual(world.step(5), 5)


class Boundaries(unittest.TestCase):
    def test_motion_and_loads(self):
        world = World(box())
        floor, lid = world.boundary("floor"), world.boundary(1)
        self.assertEqual((floor.name, lid.name, lid.mass, floor.mass), ("floor", "lid", 1e-3, 0))
        floor.v = [0, 0, 0.01]
        lid.F = [0, 0, 1e-3 * 9.81]
        world.step(100)
        np.testing.assert_allclose(floor.r, [0, 0, 1e-5], atol=1e-15)
        np.testing.assert_allclose(lid.v, 0, atol=1e-12)
        lid.v, lid.omega = [0, 0, -1], [0, 0, 2]
        np.testing.assert_array_equal(lid.omega, [0, 0, 2])
        world.step(100)
        np.testing.assert_allclose(lid.v, [0, 0, -1], atol=1e-12)
        F, T = floor.wrench()
        totals = world.totals()
        np.testing.assert_array_equal((F, T), (totals.F[0], totals.T[0]))
        contacts = world.contacts()
        np.testing.assert_allclose(-contacts.F[contacts.boundary & (contacts.j == 0)].sum(axis=0), F, rtol=1e-12, atol=1e-15)
        self.assertEqual(lid.load()[0].shape, (3,))
        np.testing.assert_allclose(totals.momentum, (world.mass[:, None] * world.v).sum(axis=0), rtol=1e-9, atol=1e-15)
        world.gravity = [0, 0, 1]
        np.testing.assert_array_equal(world.gravity, [0, 0, 1])

    def test_refusals(self):
        world = World(box(boundaries=[{"name": "floor", "type": "plane", "normal": [0, 0, 1], "r": [0, 0, "0*t"]}]))
        floor = world.boundary("floor")

        def assign(name, value):
            setattr(floor, name, value)

        for call, text in ((lambda: world.boundary("flor"), "the case has no boundary 'flor'; did you mean 'floor'"),
                           (lambda: world.boundary(3), "World.boundary: the number must be a whole number from 0 to 0, got 3"),
                           (lambda: assign("v", [0, 0, 1]), "boundary 'floor' has a formula in the case that prescribes it"),
                           (lambda: assign("F", [0, 0, 1]), "Boundary.F: boundary 'floor' has no mass"),
                           (lambda: assign("omega", [0, 1]), r"Boundary.omega of 'floor': must have the shape \(3,\), got \(2,\)"),
                           (lambda: assign("omega", [0, 1, np.inf]), r"must be finite, got inf at index \[2\]"),
                           (floor.load, "Boundary.load: boundary 'floor' has no mass"),
                           (lambda: setattr(world, "gravity", 3), r"World.gravity: must have the shape \(3,\), got \(\)")):
            with self.subTest(text=text), self.assertRaisesRegex(InvalidInput, text):
                call()


class Cases(unittest.TestCase):
    def test_built_in_cases(self):
        self.assertIn("bed", hilda_granular.cases())
        with self.assertRaisesRegex(InvalidInput, "bde: .*did you mean 'bed'"):
            World("bde")

    def test_errors_have_their_place(self):
        for case, text in ((box(step=-1), r"case:\d+:\d+ \(/step\): step must be positive"),
                           (box(step=1), r"\(/step\): step must not be above .*, got 1; --accept-step accepts it"),
                           (box(end=1e-7), r"\(/end\): end must be at least one step"),
                           (box(steps=3), "steps"), ({}, "hilda_case")):
            with self.subTest(text=text):
                with self.assertRaisesRegex(InvalidInput, text) as raised:
                    World(case)
                self.assertNotIn("\n", str(raised.exception))
        with self.assertRaisesRegex(InvalidInput, r"/boundaries/7.*--set|--set .*/boundaries/7"):
            World(box(), set={"/boundaries/7/r": [0, 0, 0]})
        with self.assertRaisesRegex(InvalidInput, "a case cannot contain a set"):
            World(box(name={1}))
        with self.assertRaisesRegex(InvalidInput, "threads must be a whole number from 1 to 1024, got 0"):
            World(box(), threads=0)
        with self.assertRaisesRegex(InvalidInput, "the device must be cpu, cuda or cuda:N, got 'gpu'"):
            World(box(), device="gpu")

    def test_files_are_relative_to_the_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "grains.csv").write_text("radius,x,y,z\n0.001,0,0,0.01\n0.001,0.01,0,0.01\n")
            case = box(fill=[{"type": "csv", "file": "grains.csv"}])
            self.assertEqual(len(World(case, folder=folder)), 2)
            case["fill"][0]["file"] = folder + "/grains.csv"
            with self.assertRaisesRegex(InvalidInput, "must be below the folder of the case"):
                World(case)
            self.assertEqual(len(World(case, allow_paths=True)), 2)

    def test_a_seed(self):
        first, second = (World("bed", seed=seed, set={"/end": 1e-4}) for seed in (1, 2))
        self.assertFalse(np.array_equal(first.r[:10], second.r[:10]))

    def test_the_content_of_a_case(self):
        self.assertEqual(World(box(), set={"/laws/0/mu": 0.7}).to_dict()["laws"][0]["mu"], 0.7)


class Process(unittest.TestCase):
    def test_neither_gsl_nor_sundials_is_loaded(self):
        code = "import hilda_granular; print(open('/proc/self/maps').read())"
        maps = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
        self.assertIn("_granular", maps)
        self.assertNotRegex(maps, "libgsl|libsundials|libklu")

    def test_both_packages_raise_their_own_exceptions(self):
        try:
            World(box(), device="cuda")
        except hilda_granular.NotAvailable as error:
            if "without CUDA" not in str(error):
                self.skipTest("GSL and the CUDA runtime would be in one process")
        import hilda

        for _ in range(2):
            with self.assertRaises(InvalidInput):
                World(box(step=-1))
            with self.assertRaises(hilda.InvalidInput):
                hilda.Model("double_pendulum", set={"/bodies/3/mass": 1}).report
        self.assertEqual(pickle.loads(pickle.dumps(hilda_granular.NumericalFailure("a", "b"))).status, "a")


if __name__ == "__main__":
    unittest.main()
