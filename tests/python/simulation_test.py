# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulations with their loop in Python, and the warnings of runs."""

import gc
import inspect
import os
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings
import weakref

import numpy as np

import hilda
from hilda import _hilda

BALL = {"hilda_model": 1, "name": "ball", "gravity": [0, 0, -10], "end": 2, "bodies": [
    {"name": "ball", "mass": 2, "inertia": [1, 2, 3], "r": [0, 0, 0], "r_dot": [1, 0, 8], "omega": [0, 0, 3]}],
    "events": [{"name": "top", "value": "ball.vz"}, {"name": "ground", "value": "ball.rz + 2.25", "direction": "falling",
                                                     "action": "stop"}]}
# 1 kg that may slide and spin, without gravity
MASS = {"hilda_model": 1, "name": "mass", "gravity": [0, 0, 0], "end": 1,
        "bodies": [{"name": "mass", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0]}]}
# 1 kg on a spring of 1e6 N/m: the stability limit is 2e-3 s
SPRING = {**MASS, "bodies": [{"name": "mass", "mass": 1, "inertia": [1, 1, 1], "r": [1.01, 0, 0]}],
          "forces": [{"type": "spring-damper", "name": "s", "body_i": "ground", "body_j": "mass", "stiffness": 1e6, "free_length": 1}]}
# 0.301 rad in a step of 1e-3 s
ROTOR = {**MASS, "name": "rotor", "end": 0.1,
         "bodies": [{"name": "rotor", "mass": 1, "inertia": [1, 2, 2.5], "r": [0, 0, 0], "omega": [301, 0, 0]}]}
FIELDS = ("r", "rdot", "rddot", "A", "omega_bar", "omegadot_bar", "lambda_")


def assert_same(a, b):
    np.testing.assert_equal(a.t, b.t)
    for name in FIELDS:
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), name)


class Steps(unittest.TestCase):
    def test_the_nodes_are_those_of_a_run(self):
        for model, integrator, keys in (("double_pendulum", "rA-half-1-momentum", {"step": 1e-3}),
                                        ("slider_crank", "rA-half-2", {"step": 1e-3}),
                                        ("braked_ball_in_bowl", "rA-half-1-momentum", {"step": 1e-3}),
                                        ("slider_crank", "rA-genalpha", {"step": 1e-3, "tolerance": 1e-12}),
                                        ("double_pendulum", "rA-dop853", {"rtol": 1e-8}),
                                        ("double_pendulum", "ida-rp", {"rtol": 1e-8})):
            nodes = []
            interval = {} if "step" in keys else {"interval": 1e-3}
            run = hilda.run(model, integrator, end=0.05, interval=interval.get("interval", 0), **keys,
                            observer=lambda x: nodes.append(x.copy()))
            sim = hilda.Simulation(model, integrator, end=0.05, **keys, **interval)
            self.assertEqual((sim.t, sim.status, sim.interval, sim.end), (0, "running", 1e-3, 0.05))
            count = 0
            with self.subTest(integrator):
                assert_same(sim.state, nodes[0])
                while sim.step():
                    count += 1
                    self.assertEqual(sim.t, run.t[count])
                    np.testing.assert_array_equal(sim.state.r, run.r[count])
                    if integrator != "ida-rp" and count in (1, 7, 49):
                        assert_same(sim.complete_state(), nodes[count])
                self.assertEqual((count, sim.status, sim.statistics), (50, "ok", run.statistics))
                self.assertFalse(sim.step())

    def test_each_setting_of_the_program_is_a_keyword(self):
        keywords = inspect.signature(hilda.Simulation).parameters
        self.assertEqual([name for name in _hilda.setting_is_switch() if name not in keywords], [])
        with self.assertRaisesRegex(hilda.UsageError, "--rtol"):
            hilda.Simulation(BALL, step=1e-3, rtol=1e-8)
        with self.assertRaisesRegex(hilda.UsageError, "interval"):
            hilda.Simulation(BALL, step=1e-3, interval=1e-2)

    def test_advance(self):
        sim = hilda.Simulation("double_pendulum", step=1e-3, end=1)
        self.assertTrue(sim.advance(0.3))
        self.assertTrue(sim.advance(0.1 + 0.2 + 0.1))
        self.assertTrue(sim.advance(sim.t))
        self.assertEqual((sim.t, sim.statistics["steps"]), (0.4, 400))
        for t, text in ((0.4005, "multiple of the step 0.001 s, such as 0.4 s or 0.401 s, got 0.4005"), (0.3, "from the present time 0.4 s"),
                        (1.001, "to the end 1 s"), (float("nan"), "must be finite")):
            with self.assertRaisesRegex(hilda.UsageError, text):
                sim.advance(t)
        self.assertEqual(sim.t, 0.4)
        by_steps = hilda.Simulation("double_pendulum", step=1e-3, end=1)
        for _ in range(400):
            by_steps.step()
        assert_same(sim.state, by_steps.state)
        adaptive = hilda.Simulation("double_pendulum", "rA-dop853", interval=0.25, end=1)
        with self.assertRaisesRegex(hilda.UsageError, "multiple of the interval 0.25 s"):
            adaptive.advance(0.3)
        self.assertTrue(adaptive.advance(0.75))
        self.assertEqual(adaptive.t, 0.75)

    def test_the_end_has_the_events_of_the_last_step(self):
        sim = hilda.Simulation({**BALL, "events": [{**BALL["events"][0], "action": "stop"}]}, "rA-rkmk-4", step=0.01, end=0.8)
        self.assertFalse(sim.advance(0.8))
        self.assertEqual((sim.status, sim.stopped_by), ("stopped", "top"))
        sim = hilda.Simulation("double_pendulum", step=0.01, end=0.1)
        self.assertTrue(sim.advance(0.1))
        self.assertEqual(sim.status, "ok")
        with self.assertRaisesRegex(hilda.UsageError, "has ended"):
            sim.set_loads()

    def test_invalid_keywords(self):
        for keywords, text in (({"stp": 1e-3}, "unknown keyword 'stp'; did you mean 'step'"),
                               ({"abc": 1}, "unknown keyword 'abc'; it has integrator, .*step, .*force, atol"),
                               ({"reparametrise": "no"}, "reparametrise must be True or False, got 'no'"),
                               ({"reparametrise": 0}, "reparametrise must be True or False, got 0")):
            for function in (hilda.Simulation, hilda.run):
                with self.assertRaisesRegex(hilda.UsageError, text):
                    function("double_pendulum", "reps-half-1", end=0.01, **keywords)
        hilda.Simulation("double_pendulum", "reps-half-1", reparametrise=np.False_)

    def test_states_can_be_kept(self):
        sim = hilda.Simulation("double_pendulum", end=1)
        start, r = sim.state, sim.state.r
        at_start = r.copy()
        sim.advance(0.5)
        np.testing.assert_array_equal(start.r, at_start)
        self.assertFalse(np.array_equal(sim.state.r, at_start))
        with self.assertRaises(ValueError):
            r[0, 0] = 1
        of = sim.state.copy()
        of.r[0, 0] = 7
        self.assertNotEqual(sim.state.r[0, 0], 7)
        kept = sim.state.r
        del sim
        gc.collect()
        self.assertTrue(np.isfinite(kept).all())

    def test_an_event_that_stops(self):
        for integrator, keys in (("rA-rkmk-4", {"step": 0.03}), ("rA-dop853", {"interval": 0.03})):
            sim = hilda.Simulation(BALL, integrator, end=1.98, **keys)
            while sim.step():
                pass
            end = 0.8 + np.sqrt(0.64 + 0.45)
            with self.subTest(integrator):
                self.assertEqual((sim.status, sim.stopped_by, sim.events.names), ("stopped", "ground", ["top", "ground"]))
                np.testing.assert_allclose(sim.events.t, [0.8, end], rtol=0, atol=1e-9)
                self.assertEqual(sim.t, sim.events.t[1])
                self.assertAlmostEqual(sim.state.r[0, 2], -2.25, delta=1e-9)
                self.assertFalse(sim.step())
                self.assertFalse(sim.advance(1.98))
                with self.assertRaisesRegex(hilda.UsageError, "has ended"):
                    sim.set_loads([[1, 0, 0]])
                with self.assertRaisesRegex(hilda.UsageError, "status stopped"):
                    sim.checkpoint()


class Failures(unittest.TestCase):
    def test_a_failed_step(self):
        sim = hilda.Simulation("double_pendulum_moving", step=0.4, end=30)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", hilda.SimulationWarning)  # the bars turn by 0.8 rad in a step
            with self.assertRaisesRegex(hilda.NumericalFailure, r"t=.*rA-half-1-momentum, h=0.4") as caught:
                while sim.step():
                    pass
        self.assertEqual(sim.status, caught.exception.status)
        self.assertNotIn(sim.status, ("running", "ok"))
        self.assertTrue(np.isfinite(sim.state.r).all())
        for call in (sim.step, lambda: sim.advance(sim.t + 0.4)):
            with self.assertRaisesRegex(hilda.UsageError, f"has failed at t = .*{sim.status}"):
                call()
        with self.assertRaisesRegex(hilda.UsageError, "the run has ended"):
            sim.set_loads()
        with self.assertRaisesRegex(hilda.UsageError, f"status {sim.status}"):
            sim.checkpoint()

    def test_an_exception_of_a_force_leaves_the_simulation_at_its_node(self):
        broken = [False]

        def push(x):
            if broken[0]:
                raise RuntimeError("planned")
            return [[1, 0, 0]]

        sim = hilda.Simulation(hilda.Model(MASS).force(push), step=0.01)
        sim.advance(0.1)
        broken[0] = True
        with self.assertRaisesRegex(RuntimeError, "planned"):
            sim.step()
        self.assertEqual((sim.t, sim.status), (0.1, "running"))
        broken[0] = False
        self.assertTrue(sim.advance(0.2))
        self.assertAlmostEqual(sim.complete_state().rdot[0, 0], 0.2, delta=1e-12)

    def test_an_exception_after_a_step_was_computed_does_not_change_the_motion(self):
        def potential(x):
            calls[0] += 1
            if calls[0] in failing:
                raise RuntimeError("planned")
            return 0

        for integrator in ("rA-half-1-momentum", "rA-half-2", "rA-half-2-bdf2", "rA-rkmk-4"):
            ends = []
            for failing in ((), range(5, 200, 9)):
                calls, raised = [0], 0
                model = hilda.Model("double_pendulum").force(lambda x: np.zeros((2, 3)), potential=potential)
                sim = hilda.Simulation(model, integrator, step=0.01, end=1)
                while sim.t < 1:
                    try:
                        sim.step()
                    except RuntimeError:
                        raised += 1
                ends.append(sim.state)
            with self.subTest(integrator):
                self.assertGreater(raised, 10)
                np.testing.assert_allclose(ends[1].r, ends[0].r, rtol=0, atol=1e-9)
                np.testing.assert_allclose(ends[1].rdot, ends[0].rdot, rtol=0, atol=1e-8)

    def test_an_exception_in_the_search_for_events_loses_no_event(self):
        def push(x):
            calls[0] += 1
            if calls[0] == fail_at:
                raise RuntimeError("planned")
            return [[0, 0, 0]]

        events = [{"name": "a", "value": "mass.rx - 0.1034"}, {"name": "b", "value": "mass.rx - 0.1036", "action": "stop"}]
        model = {**MASS, "bodies": [{**MASS["bodies"][0], "r_dot": [1, 0, 0]}], "events": events}
        for integrator in ("rA-rkmk-4", "rA-half-1-momentum"):
            for fail_at in range(1, 40):
                calls = [-10**9]
                sim = hilda.Simulation(hilda.Model(model).force(push), integrator, step=0.01, end=0.2)
                sim.advance(0.1)
                calls = [0]
                more = True
                while more:
                    try:
                        more = sim.step()
                    except RuntimeError:
                        pass
                self.assertEqual((sim.status, sim.events.names), ("stopped", ["a", "b"]), (integrator, fail_at))
                np.testing.assert_allclose(sim.events.t, [0.1034, 0.1036], rtol=0, atol=1e-12)

    def test_the_simulation_cannot_be_used_during_a_step(self):
        sim = None

        def push(x):
            if sim is not None:
                sim.set_loads([[1, 0, 0]])
            return [[0, 0, 0]]

        sim = hilda.Simulation(hilda.Model(MASS).force(push), step=0.01)
        with self.assertRaisesRegex(hilda.UsageError, "cannot be used by a function of its model or another thread"):
            sim.step()
        self.assertEqual(sim.t, 0)

    def test_two_threads(self):
        begun = threading.Event()

        def slow(x):
            begun.set()
            time.sleep(1e-3)
            return [[0, 0, 0]]

        sim = hilda.Simulation(hilda.Model(MASS).force(slow), step=0.01)
        thread = threading.Thread(target=sim.advance, args=(1,))
        begun.clear()
        thread.start()
        begun.wait()
        with self.assertRaisesRegex(hilda.UsageError, "another thread"):
            sim.step()
        thread.join()
        self.assertEqual(sim.t, 1)

    def test_interruption(self):
        code = """
import hilda, os, signal, threading
for integrator, keys in (("rA-half-1", {"step": 1e-7}), ("rA-dop853", {"rtol": 1e-13, "interval": 1e5})):
    sim = hilda.Simulation("double_pendulum", integrator, end=1e5, **keys)
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    try:
        sim.advance(1e5)
    except KeyboardInterrupt:
        at = sim.t
        print(sim.status, 0 <= at < 1e5)
        if "step" in keys:
            print(sim.step(), sim.t > at)
"""
        ended = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=100)
        self.assertEqual(ended.stdout.split(), ["running", "True", "True", "True", "running", "True"])

    def test_functions_that_refer_to_the_simulation_are_collected(self):
        class Owner:
            load = [[0, 0, 0]]

        def cycle():
            owner = Owner()
            owner.sim = hilda.Simulation(hilda.Model(MASS).force(lambda x: owner.load), step=0.01)
            owner.sim.step()
            return weakref.ref(owner)

        gc.disable()
        self.addCleanup(gc.enable)
        reference = cycle()
        self.assertIsNotNone(reference())
        gc.collect()
        self.assertIsNone(reference())


class Loads(unittest.TestCase):
    def test_a_force_and_a_torque_of_piecewise_constant_size(self):
        # exact for methods that integrate constant loads exactly; others shift a change by up to half a step
        h = 0.01
        for integrator, exact in (("rA-rkmk-4", True), ("rA-rattle", True), ("rA-dop853", True), ("rA-dop853 adaptive", True),
                                  ("rA-rattle-adaptive adaptive", True), ("rA-half-1-momentum", False), ("rA-half-1", False),
                                  ("rA-genalpha", False)):
            name, _, adaptive = integrator.partition(" ")
            sim = hilda.Simulation(MASS, name, **{"interval" if adaptive else "step": h})
            x = v = w = 0.0
            for n in range(10):
                F, M = n - 4.5, 0.3 * n
                sim.set_loads([[F, 0, 0]], [[0, 0, M]])
                np.testing.assert_array_equal(sim.loads[0], [[F, 0, 0]])
                np.testing.assert_array_equal(sim.loads[1], [[0, 0, M]])
                self.assertTrue(sim.advance(0.1 * (n + 1)))
                x, v, w = x + 0.1 * v + 0.005 * F, v + 0.1 * F, w + 0.1 * M
            state = sim.state
            with self.subTest(integrator):
                most = 1e-12 if exact else 9.5 * h
                self.assertAlmostEqual(state.rdot[0, 0], v, delta=most)
                self.assertAlmostEqual(state.omega_bar[0, 2], w, delta=most)
                self.assertAlmostEqual(state.r[0, 0], x, delta=1e-12 if exact else 9.5 * h)
                self.assertEqual(sim.warnings, [])

    def test_sampled_values_of_a_smooth_load_have_the_order_of_leapfrog(self):
        # x'' = cos t, x(0) = x'(0) = 0: x = 1 - cos t
        errors = []
        for h in (0.02, 0.01):
            sim = hilda.Simulation({**MASS, "end": 4}, "rA-half-1-momentum", step=h)
            sim.set_loads([[np.cos(sim.t), 0, 0]])
            while sim.step():
                sim.set_loads([[np.cos(sim.t), 0, 0]])
            errors.append(abs(sim.state.r[0, 0] - (1 - np.cos(4))))
        self.assertAlmostEqual(np.log2(errors[0] / errors[1]), 2, delta=0.1)

    def test_the_state_of_an_event_after_a_change_of_the_loads_satisfies_it(self):
        model = {**MASS, "events": [{"name": "v", "value": "mass.vx - 0.35"}]}
        for integrator in ("rA-rkmk-4", "rA-half-1-momentum", "rA-half-1", "rA-half-2", "rA-rattle", "rA-genalpha"):
            sim = hilda.Simulation(model, integrator, step=0.01, end=0.3)
            sim.advance(0.1)
            sim.set_loads([[100, 0, 0]])
            sim.step()
            sim.set_loads()
            sim.advance(0.3)
            with self.subTest(integrator):
                self.assertEqual(sim.events.names, ["v"])
                self.assertGreaterEqual(sim.events.rdot[0, 0, 0], 0.35 - 1e-12)
                self.assertLess(abs(sim.events.t[0] - 0.1035), 0.01)

    def test_multipliers_and_accelerations_at_the_start_follow_the_loads(self):
        sim = hilda.Simulation("double_pendulum", "rA-half-1-momentum", end=1)
        before = sim.state
        sim.set_loads(np.full((2, 3), 100.0))
        after = sim.state
        self.assertFalse(np.array_equal(before.lambda_, after.lambda_))
        system = hilda.System(sim.model._core())
        # M v' + C^T lambda = loads, with the loads of the state
        F, n_bar = system.loads(after)
        C = system.jacobian(after)
        J_omega = np.einsum("bij,bj->bi", system.inertia, after.omega_bar)
        force = system.mass[:, None] * after.rddot + np.einsum("kbi,k->bi", C[:, :, :3], after.lambda_)
        torque = np.einsum("bij,bj->bi", system.inertia, after.omegadot_bar) + np.einsum("kbi,k->bi", C[:, :, 3:], after.lambda_)
        np.testing.assert_allclose(force, F, atol=1e-9)
        np.testing.assert_allclose(torque, n_bar - np.cross(after.omega_bar, J_omega), atol=1e-9)
        np.testing.assert_allclose(F - system.loads(before)[0], 100, rtol=1e-12)
        sim.set_loads()
        np.testing.assert_allclose(sim.state.lambda_, before.lambda_, atol=1e-9)

    def test_a_feedback_loop_and_a_model_that_is_shared(self):
        model = hilda.Model(MASS)
        free, held = hilda.Simulation(model, step=1e-3), hilda.Simulation(model, step=1e-3)
        free.set_loads([[1, 0, 0]])
        for sim in (free, held):
            sim.advance(0.5)
        self.assertAlmostEqual(free.state.r[0, 0], 0.125, delta=1e-9)
        self.assertEqual(held.state.r[0, 0], 0)
        # A critically damped controller takes the free mass to x = 1.
        sim = hilda.Simulation({**MASS, "end": 3}, step=1e-3)
        while sim.step():
            x = sim.state
            sim.set_loads(100 * ([1, 0, 0] - x.r) - 20 * x.rdot)
        self.assertAlmostEqual(sim.state.r[0, 0], 1, delta=1e-10)
        self.assertEqual(sim.warnings, [])  # its energy rises by the work of the loads

    def test_invalid_loads(self):
        sim = hilda.Simulation("double_pendulum", end=1)
        with self.assertRaisesRegex(ValueError, r"F must have the shape \(2, 3\), got \(1, 3\)"):
            sim.set_loads([[1, 0, 0]])
        with self.assertRaisesRegex(ValueError, "n_bar is not finite"):
            sim.set_loads(None, [[0, 0, 0], [0, 0, float("nan")]])
        with self.assertRaisesRegex(TypeError, "array of numbers"):
            sim.set_loads("much")
        np.testing.assert_array_equal(sim.loads[0], np.zeros((2, 3)))
        with self.assertRaisesRegex(hilda.UsageError, "ida-rp stores past steps outside the state"):
            hilda.Simulation("double_pendulum", "ida-rp", end=1).set_loads(np.ones((2, 3)))


class Checkpoints(unittest.TestCase):
    def test_a_continued_run_has_the_digits_of_a_whole_one(self):
        for model, integrator, keys, interval in (
                ("braked_ball_in_bowl", "rA-half-1-momentum", {"step": 1e-3}, 1e-3),  # friction with internal states
                ("edge_mill", "rA-half-1-momentum", {"step": 1e-3}, 1e-3),
                ("rolling_ball", "rA-rattle", {"step": 1e-4}, 1e-4),
                ("slider_crank", "rA-half-2-bdf2", {"step": 2e-3}, 2e-3),
                ("slider_crank", "rA-genalpha", {"step": 2e-3}, 2e-3),
                ("n_pendulum_2_spin", "rA-dop853", {"rtol": 1e-9, "interval": 1e-2}, 1e-2),
                ("n_pendulum_2_spin", "rA-radau-5", {"rtol": 1e-7, "interval": 1e-2}, 1e-2)):
            with self.subTest(model=model, integrator=integrator):
                def made():
                    return hilda.Simulation(model, integrator, end=200 * interval, **keys)

                def steps(sim, last):
                    while (n := round(sim.t / interval)) < last:
                        if n in (0, 40, 60):
                            load = np.zeros(sim.state.r.shape)
                            load[-1] = {0: [0, 0, 0], 40: [0.2, 0.1, 0], 60: [0.1, 0, 0.1]}[n]
                            sim.set_loads(load, 0.01 * load)
                        self.assertTrue(sim.step())

                whole, first = made(), made()
                steps(whole, 150)
                steps(first, 70)
                data, first_t = first.checkpoint(), first.t
                self.assertIsInstance(data, bytes)
                steps(first, 150)  # a checkpoint changes nothing
                again = made()
                again.restore(data)
                self.assertEqual((again.t, again.loads[0][-1, 0]), (first_t, 0.1))
                steps(again, 150)
                for sim in (first, again):
                    assert_same(sim.state, whole.state)
                    self.assertEqual(sim.statistics, whole.statistics)
                first.restore(data)  # back to an earlier node
                steps(first, 150)
                assert_same(first.state, whole.state)
                self.assertEqual(first.checkpoint(), whole.checkpoint())

    def test_events_and_the_end(self):
        sim = hilda.Simulation(BALL, "rA-rkmk-4", step=0.01, end=1)
        sim.advance(0.9)
        self.assertEqual(sim.events.names, ["top"])
        later = hilda.Simulation(BALL, "rA-rkmk-4", step=0.01, end=2)
        later.restore(sim.checkpoint())
        while later.step():
            pass
        self.assertEqual((later.events.names, later.status), (["top", "ground"], "stopped"))
        whole = hilda.run(BALL, "rA-rkmk-4", step=0.01, end=2)
        np.testing.assert_array_equal(later.events.t, whole.events.t)
        # The checkpoint at the end is one before the check of the last node.
        while sim.t < 1:
            sim.step()
        before = sim.checkpoint()
        self.assertFalse(sim.step())
        self.assertEqual((sim.status, sim.checkpoint()), ("ok", before))
        later.restore(before)
        self.assertEqual((later.t, later.status, later.events.names), (1, "running", ["top"]))
        with self.assertRaisesRegex(hilda.UsageError, "at t = 1 s, after the end 0.5 s"):
            hilda.Simulation(BALL, "rA-rkmk-4", step=0.01, end=0.5).restore(before)

    def test_a_failed_simulation_continues_from_an_earlier_node(self):
        strong = [False]
        model = hilda.Model(MASS).force(lambda x: [[float("1e300") if strong[0] else 1, 0, 0]])
        sim = hilda.Simulation(model, "rA-rkmk-4", step=0.01)
        sim.advance(0.2)
        data = sim.checkpoint()
        strong[0] = True
        with self.assertRaises(hilda.NumericalFailure):
            sim.advance(0.5)
        strong[0] = False
        sim.restore(data)
        self.assertTrue(sim.advance(1))
        self.assertAlmostEqual(sim.state.r[0, 0], 0.5, delta=1e-12)

    def test_another_run_is_refused(self):
        data = hilda.Simulation("double_pendulum", step=1e-3, end=1).checkpoint()

        def restored(model="double_pendulum", integrator=_hilda.default_integrator, **keys):
            hilda.Simulation(model, integrator, **{"step": 1e-3, "end": 1, **keys}).restore(data)

        restored()
        restored(end=3)
        for keys, text in (({"model": "single_pendulum"}, "another model"), ({"integrator": "rA-half-1"}, "rA-half-1"),
                           ({"step": 2e-3}, "--step 0.001; this run has --step 0.002"),
                           ({"tolerance": 1e-12}, "--tolerance"),
                           ({"model": hilda.Model("double_pendulum").force(lambda x: np.zeros((2, 3)), name="wind")}, "functions wind")):
            with self.assertRaisesRegex(hilda.UsageError, "the checkpoint belongs to another run: .*" + text):
                restored(**keys)
        for bad in (b"", b"text", data[:-1], data[:100] + b"x" + data[101:], data + b"x"):
            with self.assertRaisesRegex(hilda.FileError, "^Simulation.restore"):
                hilda.Simulation("double_pendulum", step=1e-3, end=1).restore(bad)
        for call in (lambda sim: sim.checkpoint(), lambda sim: sim.restore(data)):
            with self.assertRaisesRegex(hilda.UsageError, "ida-rp stores past steps outside the state"):
                call(hilda.Simulation("double_pendulum", "ida-rp", end=1))


class Warnings(unittest.TestCase):
    def warned(self, function):
        """Texts of the warnings, all of which name this file"""
        with warnings.catch_warnings(record=True) as all_of:
            warnings.simplefilter("always")
            self.result = function()
        for warning in all_of:
            self.assertIs(warning.category, hilda.SimulationWarning)
            self.assertEqual(os.path.basename(warning.filename), os.path.basename(__file__))
        return [str(warning.message) for warning in all_of]

    def test_a_run(self):
        for run in (lambda: hilda.run(ROTOR), lambda: hilda.Model(ROTOR).run()):
            (text,) = self.warned(run)
            self.assertIn("body 'rotor' turns by 0.301 rad", text)
            self.assertEqual(self.result.warnings, [text])
            self.assertIn("1 warning: body 'rotor' turns", repr(self.result))
        self.assertEqual(self.warned(lambda: hilda.run(MASS, end=0.1)), [])
        self.assertNotIn("warning", repr(self.result))
        with warnings.catch_warnings():
            warnings.simplefilter("error", hilda.SimulationWarning)
            with self.assertRaisesRegex(hilda.SimulationWarning, "turns by"):
                hilda.run(ROTOR)
        self.assertTrue(issubclass(hilda.SimulationWarning, UserWarning))

    def test_an_accepted_step_that_is_unstable_and_the_end(self):
        texts = self.warned(lambda: hilda.run({**SPRING, "end": 0.0151}, step=2.0e-3 + 1e-5, force=True))
        self.assertEqual(self.result.warnings, texts)
        self.assertTrue(any("stability limit" in text for text in texts))
        self.assertTrue(any("multiple of the step" in text for text in texts))
        with warnings.catch_warnings():
            warnings.simplefilter("error", hilda.SimulationWarning)  # the warnings before a run end it there
            with self.assertRaises(hilda.SimulationWarning):
                hilda.run({**SPRING, "end": 0.0151}, step=2.0e-3 + 1e-5, force=True, observer=self.fail)

    def test_a_failure_is_not_replaced(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error", hilda.SimulationWarning)
            with self.assertRaises(hilda.NumericalFailure):
                hilda.run("double_pendulum_moving", step=0.4, end=30)

    def test_a_wrong_derivative(self):
        model = hilda.Model(name="rail", gravity=[0, 0, -9.81], end=0.01)
        model.body("bead", mass=1, inertia=[1, 1, 1], r=[0, 0, 0])

        def rail(x):
            return [x.r[1][2] - x.r[1][0] * x.r[1][0]]

        def wrong(x):
            C_i, C_j = np.zeros((1, 6)), np.zeros((1, 6))
            C_j[0, 2] = 1.5
            return C_i, C_j

        model.constraint(rail, body_i="ground", body_j="bead", variation=wrong)
        texts = self.warned(lambda: hilda.Simulation(model))
        self.assertTrue(any("'rail': C_j of row 1 is 1.5, by differences 1" in text for text in texts), texts)
        self.assertEqual(self.result.model.warnings, texts)

    def test_a_simulation_reports_each_kind_once_at_the_line_of_its_step(self):
        self.assertEqual(self.warned(lambda: hilda.Simulation(ROTOR)), [])
        sim = self.result
        (text,) = self.warned(sim.step) + self.warned(sim.step)
        self.assertIn("rotor", text)
        self.assertEqual(self.warned(lambda: sim.advance(0.1)), [])
        self.assertEqual(len(sim.warnings), 1)
        self.assertEqual(len(self.warned(lambda: hilda.Simulation({**SPRING, "end": 0.0201}, step=2.01e-3, force=True))), 1)

    def test_several_runs(self):
        turning = {**ROTOR, "bodies": [{**ROTOR["bodies"][0], "omega": [31, 0, 0]}]}
        texts = self.warned(lambda: hilda.sweep(turning, {"/bodies/0/omega/0": [31, 350, 400]}, {"t": lambda result: result.t[-1]}, jobs=2))
        self.assertEqual(len(texts), 2)
        self.assertIn("/bodies/0/omega/0 = 350: body 'rotor' turns", texts[0])
        (text,) = self.warned(lambda: hilda.convergence(turning, ["rA-rkmk-4"], [1e-2, 5e-3, 2.5e-3], end=0.1))
        self.assertIn("rA-rkmk-4 at h = 0.01 s: body 'rotor' turns", text)
        (text,) = self.warned(lambda: hilda.work_precision(turning, ["rA-rkmk-4"], [1e-2, 5e-3], end=0.1, instants=10))
        self.assertIn("rA-rkmk-4 with step 0.01: body 'rotor' turns", text)

    def test_the_line_of_a_thread_and_of_a_script(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(folder + "/script.py", "w", encoding="utf-8") as file:
                file.write(f"import hilda\n\nhilda.run({ROTOR})\n")
            ended = subprocess.run([sys.executable, folder + "/script.py"], check=True, capture_output=True, text=True)
        self.assertRegex(ended.stderr, r"script.py:3: SimulationWarning: body 'rotor' turns")


if __name__ == "__main__":
    unittest.main()
