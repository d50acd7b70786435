# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Python: the numbers of the program, observers, failures, interruptions, threads."""

import csv
import inspect
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import hilda
from hilda import _hilda

PROGRAM = os.environ["HILDA_PROGRAM"]


class Settings(unittest.TestCase):
    def test_each_setting_of_the_program_is_a_keyword(self):
        keywords = inspect.signature(hilda.Model.run).parameters
        self.assertEqual([name for name in _hilda.setting_is_switch() if name not in keywords], [])
        self.assertIn("reparametrise", _hilda.setting_is_switch())

    def test_an_unknown_setting(self):
        with self.assertRaisesRegex(hilda.UsageError, "run: unknown keyword 'damp'; it has integrator, .*force, atol, "):
            hilda.run("double_pendulum", damp=1)

    def test_euler_angles_at_a_singular_orientation(self):
        # the Euler angle phi of the crank is 0 at 0.236 s
        with self.assertRaisesRegex(hilda.NumericalFailure, "singular"):
            hilda.run("slider_crank", "reps-half-1", end=0.5)
        self.assertEqual(hilda.run("slider_crank", "reps-half-1", end=0.5, reparametrise=True).status, "ok")


class Rows(unittest.TestCase):
    def check_as_program(self, model, *options, **keys):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([PROGRAM, "run", model, *options, "--quiet", "--output", folder + "/a"], check=True,
                           capture_output=True)
            with open(folder + "/a/trajectory.csv", encoding="utf-8") as file:
                rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        result = hilda.run(model, **keys)
        self.assertEqual(len(rows), len(result))
        body = result.bodies[-1]
        for name, array in (("r", result[body].r), ("v", result[body].rdot), ("w", result[body].omega_bar)):
            for k, axis in enumerate("xyz"):
                column = next(c for c in rows[0] if c.startswith(f"{body}.{name}{axis}"))
                np.testing.assert_array_equal([float(row[column]) for row in rows], array[:, k])

    def test_rows_are_those_of_the_program(self):
        self.check_as_program("double_pendulum", "--end", "0.5", end=0.5)
        self.check_as_program("slider_crank", "--integrator", "rA-half-1", "--end", "0.5", "--step", "2e-3", "--interval", "0.02",
                              integrator="rA-half-1", end=0.5, step=2e-3, interval=0.02)
        self.check_as_program("double_pendulum_moving", "--integrator", "rA-dop853", "--rtol", "1e-8", "--end", "1", "--interval",
                              "0.1", integrator="rA-dop853", rtol=1e-8, end=1, interval=0.1)

    def test_shapes_and_invariants(self):
        result = hilda.run("double_pendulum", end=1, reactions=True)
        n = len(result.t)
        self.assertEqual(n, 1001)
        self.assertEqual(result.r.shape, (n, 2, 3))
        self.assertEqual(result.A.shape, (n, 2, 3, 3))
        self.assertEqual(result.lambda_.shape, (n, 10))
        self.assertEqual(result.reaction_F.shape, (n, 2, 3))
        product = np.einsum("nbki,nbkj->nbij", result.A, result.A)
        self.assertLess(np.abs(product - np.eye(3)).max(), 1e-14)
        self.assertLess(np.ptp(result.energy), 1e-4 * abs(result.energy[0]))
        # Newton's second law: m r'' = m g + reaction
        mass = hilda.Model("double_pendulum").to_dict()["bodies"][1]["mass"]
        np.testing.assert_allclose(mass * (result.rddot[:, 1] - [0, 0, -9.81]), result.reaction_F[:, 1], atol=1e-9)

    def test_the_arrays_are_not_copied_and_outlive_the_model(self):
        model = hilda.Model("double_pendulum")
        result = model.run(end=0.1)
        del model
        self.assertIsNotNone(result.r.base)  # a part of the array that the run has written
        self.assertTrue(result.r.flags["C_CONTIGUOUS"])
        self.assertTrue(np.isfinite(result.r).all())

    def test_the_memory_is_that_of_the_arrays(self):
        code = """
import resource, hilda
def peak():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
hilda.run("single_pendulum", "rA-half-1", end=0.01)
before = peak()
r = hilda.run("single_pendulum", "rA-half-1", step=1e-5, end=3, interval=0)
arrays = (r.t, r.r, r.A, r.rdot, r.omega_bar, r.rddot, r.omegadot_bar, r.lambda_, r.energy)
print(len(r.t), (peak() - before) / sum(a.nbytes for a in arrays))
"""
        rows, ratio = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.split()
        self.assertEqual(int(rows), 300001)
        self.assertLess(float(ratio), 1.1)

    def test_repeated_runs_are_equal(self):
        model = hilda.Model("slider_crank")
        np.testing.assert_array_equal(model.run(end=0.2).r, model.run(end=0.2).r)

    def test_names_of_bodies(self):
        result = hilda.run("slider_crank", end=0.01)
        np.testing.assert_array_equal(result["slider"].r, result.r[:, result.bodies.index("slider")])
        with self.assertRaisesRegex(KeyError, "no body 'rod2'; the bodies are "):
            result["rod2"]

    def test_events(self):
        ball = {"hilda_model": 1, "name": "ball", "gravity": [0, 0, -10], "end": 2, "bodies": [
            {"name": "ball", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0], "r_dot": [1, 0, 8], "omega": [0, 0, 3]}],
            "events": [{"name": "top", "value": "ball.vz"}, {"name": "level", "value": "ball.rz - 2.4"},
                       {"name": "ground", "value": "ball.rz + 2.25", "direction": "falling", "action": "stop"}]}
        for integrator, keys, most in (("rA-rkmk-4", {"step": 0.03}, 1e-9), ("rA-dop853", {}, 1e-9), ("rA-half-1-momentum", {"step": 0.01}, 1e-9)):
            result = hilda.run(ball, integrator, end=1.98, **keys)
            events = result.events
            with self.subTest(integrator):
                self.assertEqual(events.names, ["level", "top", "level", "ground"])
                np.testing.assert_array_equal(events.rises, [True, False, False, False])
                end = 0.8 + np.sqrt(0.64 + 0.45)
                np.testing.assert_allclose(events.t, [0.4, 0.8, 1.2, end], rtol=0, atol=most)
                np.testing.assert_allclose(events.r[:, 0, 0], events.t, rtol=0, atol=most)
                np.testing.assert_allclose(events.rdot[:, 0, 2], 8 - 10 * events.t, rtol=0, atol=10 * most)
                np.testing.assert_allclose(events.A[:, 0, 0, 0], np.cos(3 * events.t), rtol=0, atol=1e-5)
                np.testing.assert_array_equal(events.at("level"), events.t[[0, 2]])
                self.assertEqual((result.status, result.stopped_by), ("stopped", "ground"))
                self.assertEqual(result.t[-1], events.t[-1])
                self.assertEqual(result.t_end, events.t[-1])
                np.testing.assert_array_equal(result.r[-1], events.r[-1])
                self.assertTrue((np.diff(result.t) > 0).all())
        with self.assertRaisesRegex(hilda.UsageError, "stores past steps"):
            hilda.run(ball, "ida-rp")
        with self.assertWarnsRegex(hilda.SimulationWarning, "is not finite at any node"):
            never = hilda.run({**ball, "events": [{"name": "e", "value": "log(-1 - ball.rx)"}]}, end=0.1)
        self.assertEqual((len(never.events), never.stopped_by), (0, None))
        self.assertIn("is not finite at any node", never.warnings[-1])
        with self.assertRaisesRegex(hilda.InvalidInput, "did you mean|unknown"):
            hilda.run({**ball, "events": [{"name": "e", "value": "ball.rq"}]})

    def test_columns(self):
        model = hilda.Model("braked_ball_in_bowl")
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([PROGRAM, "run", "braked_ball_in_bowl", "--end", "0.2", "--contacts", "--quiet", "--output", folder + "/a"],
                           check=True, capture_output=True)
            with open(folder + "/a/contacts.csv", encoding="utf-8") as file:
                rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        result = model.run(end=0.2, columns="contacts")
        self.assertEqual(list(result.columns), [name for name in rows[0] if name != "t"])
        for name, values in result.columns.items():
            np.testing.assert_array_equal(values, [float(row[name]) for row in rows])
        wheel = {"hilda_model": 1, "name": "wheel", "bodies": [
            {"name": "wheel", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0], "omega": [0, 20, 0]}],
            "constraints": [{"type": "revolute", "name": "axle", "body_i": "ground", "body_j": "wheel", "axis_bar_i": [0, 1, 0],
                             "axis_bar_j": [0, 1, 0]}],
            "outputs": [{"type": "expression", "name": "twice", "value": "2*wheel.wy"}]}
        result = hilda.run(wheel, end=1, interval=0.25, columns=["outputs", "energy"])
        self.assertEqual(list(result.columns), ["twice", "energy"])
        np.testing.assert_allclose(result.columns["twice"], 40)
        np.testing.assert_array_equal(result.columns["energy"], result.energy)
        self.assertGreater(result.seconds, 0)
        with self.assertRaisesRegex(hilda.UsageError, "no column 'twic'; did you mean 'twice'"):
            hilda.run(wheel, columns=["twic"])

    def test_an_end_between_two_steps_is_a_warning(self):
        text = "the end 0.0105 s is not a multiple of the step: the run ends at 0.011 s"
        with self.assertWarnsRegex(hilda.SimulationWarning, text):
            result = hilda.run("double_pendulum", end=0.0105, interval=0.0015)
        self.assertIn(text, result.warnings)


class Observers(unittest.TestCase):
    def test_an_observer_sees_the_nodes(self):
        seen = []
        result = hilda.run("double_pendulum", end=0.02, interval=0, observer=lambda x: seen.append((x.t, x.r[1].copy())))
        np.testing.assert_array_equal([t for t, r in seen], result.t)
        np.testing.assert_array_equal([r for t, r in seen], result.r[:, 1])

    def test_an_observer_ends_the_run(self):
        calls = []
        for condition in (lambda x: x.t >= 0.5, lambda x: x.r[1, 2] < -1.2):  # a bool of Python, and one of NumPy
            result = hilda.run("double_pendulum", observer=lambda x: calls.append(x.t) or condition(x), interval=0)
            self.assertEqual(result.status, "stopped")
            self.assertLess(abs(result.t_end - calls[-1]), 1.5e-3)
            self.assertLess(result.t_end, 2)

    def test_the_arrays_of_an_observer_are_read_only(self):
        def write(x):
            x.r[0, 0] = 1

        with self.assertRaisesRegex(ValueError, "read-only") as raised:
            hilda.run("double_pendulum", observer=write)
        self.assertIn("in the observer at t = 0 s", raised.exception.__notes__)
        self.assertEqual(raised.exception.result.status, "error")

    def test_a_kept_state_stays_valid(self):
        kept = []
        hilda.run("double_pendulum", end=0.01, observer=lambda x: kept.append(x.copy()))
        self.assertEqual([x.t for x in kept[:2]], [0, 1e-3])
        kept[0].r[0] = [1, 2, 3]
        self.assertEqual(kept[0].r[0, 2], 3)
        arrays = []
        result = hilda.run("double_pendulum", end=0.01, interval=0, observer=lambda x: arrays.append(x.r))
        np.testing.assert_array_equal(arrays, result.r)

    def test_a_part_of_the_rows_remains_after_an_exception(self):
        def fail(x):
            if x.t > 0.1:
                raise KeyError("no more")

        with self.assertRaises(KeyError) as raised:
            hilda.run("double_pendulum", observer=fail)
        result = raised.exception.result
        self.assertGreater(len(result), 30)
        self.assertLess(result.t[-1], 0.11)


class Failures(unittest.TestCase):
    def test_a_numerical_failure_has_its_status_and_the_rows(self):
        model = hilda.Model("double_pendulum_moving")
        with self.assertRaises(hilda.NumericalFailure) as raised:
            model.run(step=0.4, end=30)
        self.assertIn(raised.exception.status, ("newton_diverged", "step_too_large", "energy_created"))
        self.assertEqual(raised.exception.result.status, raised.exception.status)
        self.assertGreater(len(raised.exception.result), 0)

    def test_options_that_do_not_fit(self):
        for keys, text in (({"integrator": "rA-half-9"}, "an integrator must be one of .*got rA-half-9"),
                           ({"rtol": 1e-6}, "no selected integrator uses --rtol; it is for ida-rp, .*rA-dop853"),
                           ({"integrator": "ida-rp", "step": 1e-3}, "ida-rp chooses its own steps by --rtol and --atol"),
                           ({"integrator": "rA-dp-5", "step": 1e-3, "rtol": 1e-6}, "has a fixed step with --step, and adaptive"),
                           ({"integrator": "rA-dp-5", "interval": 0}, "--interval must be positive, got 0"),
                           ({"integrator": "rA-dp-5", "interval": -1}, "h must be positive and finite .*got -1"),
                           ({"integrator": "rA-dp-5", "atol": -1}, "--atol: must be a number from 1e-14 to 0.1, got .*-1"),
                           ({"integrator": "rA-dp-5", "rtol": 1.0}, "--rtol: must be a number from 1e-14 .* to 0.1"),
                           ({"rho_infinity": 0.5}, "no selected integrator uses --rho-infinity; it is for rA-genalpha"),
                           ({"integrator": "rA-genalpha", "rho_infinity": 2}, "--rho-infinity: must be .*got .*2"),
                           ({"tolerance": float("nan")}, "--tolerance: must be .*got .*nan"),
                           ({"max_iterations": 0}, "--max-iterations: must be .*got .*0"),
                           ({"step": 0.0}, "the step h must be positive and finite"),
                           ({"end": -1}, "the end time must be finite and not negative"),
                           ({"linear_solver": "lu"}, "--linear-solver: must be auto, klu or condensed, got .*lu")):
            with self.subTest(**keys), self.assertRaisesRegex((hilda.UsageError, hilda.InvalidInput), text):
                hilda.run("double_pendulum", **keys)

    def test_a_failure_can_be_passed_between_processes(self):
        with self.assertRaises(hilda.NumericalFailure) as raised:
            hilda.run("double_pendulum_moving", step=0.4, end=30)
        copy = pickle.loads(pickle.dumps(raised.exception))
        self.assertEqual((copy.status, str(copy)), (raised.exception.status, str(raised.exception)))
        np.testing.assert_array_equal(copy.result.r, raised.exception.result.r)
        model = hilda.Model("double_pendulum")
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(model)).run(end=0.1).r, model.run(end=0.1).r)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(model)).run(end=0.1).r, model.run(end=0.1).r)

    def test_a_step_above_the_stability_limit(self):
        model = hilda.Model("double_pendulum_strut", set={"/forces/0/implicit": False})
        with self.assertRaisesRegex(hilda.UsageError, "the stability limit of .* in an explicit step"):
            model.run("rA-rattle", step=0.1)


class Interruptions(unittest.TestCase):
    def check_interrupted(self, **keys):
        model = hilda.Model("double_pendulum")
        model.report  # the model is read before the signal
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        begin = time.process_time()
        with self.assertRaises(KeyboardInterrupt) as raised:
            model.run(**keys)
        self.assertLess(time.process_time() - begin, 1.3)
        self.assertEqual(raised.exception.result.status, "interrupted")
        return raised.exception.result

    def test_ctrl_c_ends_a_run_within_a_second(self):
        result = self.check_interrupted(end=1e6, interval=1)
        self.assertGreater(len(result), 1)
        self.assertGreater(result.t_end, 0)

    def test_ctrl_c_inside_of_an_adaptive_step(self):
        self.check_interrupted(integrator="rA-dp-5", end=1e6, interval=1e6)

    def test_other_threads_run_meanwhile(self):
        results = [None, None]

        def run(k):
            results[k] = hilda.run(model, end=3)

        model = hilda.Model("double_pendulum").force(lambda x: np.zeros((2, 3)))
        alone = model.run(end=3)
        threads = [threading.Thread(target=run, args=(k,)) for k in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for result in results:
            np.testing.assert_array_equal(result.r, alone.r)


if __name__ == "__main__":
    unittest.main()
