# SPDX-License-Identifier: GPL-3.0-or-later
"""Steps of a world in Python: functions before each step, observers, failures, interruptions, threads, processes."""

import gc
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
import unittest
import weakref

import numpy as np

import hilda_granular
from hilda_granular import InvalidInput, NumericalFailure, UsageError, World


def grains(**keys):
    """64 particles above a floor, and a plate without contacts."""
    return {"hilda_case": 1, "name": "grains", "domain": {"low": [-0.01, -0.01, -0.005], "high": [0.03, 0.03, 0.06]},
            "step": 1e-5, "end": 0.01, "interval": 1e-3, "materials": [{"name": "glass", "density": 2500, "E": 1e7, "nu": 0.24}],
            "laws": [{"restitution": 0.5, "mu": 0.3, "tangential": {"law": "mindlin"}}],
            "boundaries": [{"name": "floor", "type": "plane", "normal": [0, 0, 1]},
                           {"name": "plate", "type": "sphere", "radius": 4e-3, "r": [0.01, 0.01, 0.05]}],
            "fill": [{"type": "lattice", "low": [0, 0, 0], "high": [0.016, 0.016, 0.016], "radius": 1.9e-3, "spacing": 1.02}], **keys}


class Functions(unittest.TestCase):
    def test_a_function_sets_the_velocity_of_a_boundary(self):
        world = World(grains())
        times = []

        @world.before_each_step
        def move(of):
            times.append(of.t)
            of.boundary("floor").v = [0, 0, 0.1 if of.t < 5e-4 else 0]

        self.assertEqual(world.step(100), 100)
        np.testing.assert_allclose(times, np.arange(100) * world.h)
        np.testing.assert_allclose(world.boundary("floor").r, [0, 0, 0.1 * 5e-4], atol=1e-12)
        expected = World(grains(boundaries=[{"name": "floor", "type": "plane", "normal": [0, 0, 1],
                                             "v": [0, 0, "0.1*min(max((5e-4 - t)/1e-9, 0), 1)"]}]))
        expected.step(100)
        np.testing.assert_array_equal(world.r, expected.r)
        self.assertGreater(world.v[:, 2].max(), 0.05)

    def test_a_function_ends_the_steps(self):
        world = World(grains())
        world.before_each_step(lambda of: of.t > 2.5e-4)
        self.assertEqual(world.step(1000), 26)
        self.assertEqual(world.step(1000), 0)
        self.assertEqual(world.run().steps, 26)

    def test_an_exception_has_the_time_and_the_world_goes_on(self):
        world, expected = World(grains()), World(grains())

        @world.before_each_step
        def fail(of):
            if of.steps == 7 and not hasattr(fail, "has_failed"):
                fail.has_failed = True
                raise KeyError("no more")

        with self.assertRaisesRegex(KeyError, "no more") as raised:
            world.step(100)
        self.assertEqual(raised.exception.__notes__, ["in the function before the step at t = 7e-05 s"])
        self.assertEqual(world.step(93), 93)
        expected.step(100)
        np.testing.assert_array_equal(world.r, expected.r)

    def test_a_function_uses_the_world_but_computes_no_steps(self):
        world = World(grains(gravity=[0, 0, 0]))
        kicked = []

        @world.before_each_step
        def kick(of):
            if of.steps == 3:
                of.set_velocity(of.id[:2], [0, 0, 1e-3])
                kicked.append((of.v[:3, 2].copy(), len(of.contacts().i), of.totals().kinetic_energy))
                of.add([0, 0, 0.04], 1e-3)

        world.step(10)
        np.testing.assert_array_equal(kicked[0][0].round(9), [1e-3, 1e-3, 0])
        self.assertEqual(len(world), 65)
        world.before_each_step(lambda of: of.step())
        with self.assertRaisesRegex(UsageError, "World.step: a function that is called before each step must not compute steps"):
            world.step()

    def test_a_world_whose_function_refers_to_it_is_collected(self):
        def make():
            world = World(grains())
            world.before_each_step(lambda of: world.t < 0)
            world.step(2)
            return weakref.ref(world)

        world = make()
        gc.collect()
        self.assertIsNone(world())


class Runs(unittest.TestCase):
    def test_an_observer_sees_the_rows(self):
        times = []
        world = hilda_granular.run(grains(), observer=lambda of: times.append(of.t))
        np.testing.assert_allclose(times, np.linspace(0, 0.01, 11), rtol=1e-12)
        self.assertEqual(world.steps, 1000)
        world.run(0.0125, interval=2e-3, observer=lambda of: times.append(of.t))
        np.testing.assert_allclose(times[11:], [0.01, 0.012, 0.0125])
        expected = World(grains())
        expected.step(1250)
        np.testing.assert_array_equal(world.r, expected.r)
        self.assertEqual(repr(world), "<hilda_granular.World grains: 64 particles, t = 0.0125 s>")

    def test_an_observer_ends_the_run(self):
        self.assertEqual(hilda_granular.run(grains(), observer=lambda of: of.t > 2.5e-3).steps, 300)
        self.assertEqual(hilda_granular.run(grains(), observer=lambda of: True).steps, 0)

        def fail(of):
            raise KeyError

        with self.assertRaises(KeyError) as raised:
            hilda_granular.run(grains(), observer=fail)
        self.assertEqual(raised.exception.__notes__, ["in the observer at t = 0 s"])

    def test_a_run_in_parts_has_no_warning_about_its_end(self):
        world = World("settle_push_load")
        before = list(world.warnings)
        world.run(10 * world.h).run(20 * world.h)
        self.assertEqual(world.warnings, before)

    def test_wrong_times(self):
        world = World(grains()).run(1e-3)
        for keys, text in (({"end": -1}, "World.run: end must be positive, got -1"),
                           ({"end": 5e-4}, "end must not be before the present time, 0.001 s, got 0.0005 s"),
                           ({"interval": 0}, "interval must be positive, got 0"),
                           ({"end": float("nan")}, "end must be positive, got nan")):
            with self.subTest(**keys), self.assertRaisesRegex(InvalidInput, text):
                world.run(**keys)
        with self.assertRaisesRegex(InvalidInput, "World.step: n must not be negative, got -1"):
            world.step(-1)
        with self.assertRaises(TypeError):
            world.step(1.5)


class Failures(unittest.TestCase):
    def test_a_lost_particle(self):
        world = World(grains(gravity=[0, 0, 0]))
        highest = np.argmax(world.r[:, 2])
        world.set_velocity(highest, [0, 0, 10])
        with self.assertRaisesRegex(NumericalFailure, f"particle {highest} has left the domain at t = ") as raised:
            world.step(10000)
        self.assertEqual(raised.exception.status, "particle_lost")
        with self.assertRaisesRegex(UsageError, "World.step: the world has failed and cannot be used any more: particle "):
            world.step()
        self.assertGreater(world.t, 0.001)

    def test_a_stage_that_fails(self):
        stages = [{"name": "rest", "duration": 1e-3, "until": {"share": 1e-9}, "on_timeout": "fail"}, {"name": "next", "duration": 1e-3}]
        world = World(grains(stages=stages))
        with self.assertRaisesRegex(NumericalFailure, "stage 'rest': its condition is not met") as raised:
            world.run()
        self.assertEqual(raised.exception.status, "stage_timeout")

    def test_warnings(self):
        stages = [{"name": "rest", "duration": 1e-3, "until": {"share": 1e-9}}, {"name": "next", "duration": 1e-3}]
        world = World(grains(stages=stages), set={"/step": 1.1e-5}).run(1.5e-3)
        self.assertEqual(world.stage, "next")
        self.assertRegex(" ".join(world.warnings), "stage 'rest': its condition is not met")


class Interruptions(unittest.TestCase):
    def test_ctrl_c_ends_the_steps_within_a_second(self):
        for keys in ({}, {"threads": 2}):
            world, expected = World(grains(), **keys), World(grains())
            world.step(1)
            threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
            begin = time.process_time()
            with self.assertRaises(KeyboardInterrupt):
                world.step(10**9)
            self.assertLess(time.process_time() - begin, 1.3 * keys.get("threads", 1))
            expected.step(world.steps)
            np.testing.assert_array_equal(world.r, expected.r)
            world.step(3)
            self.assertEqual(world.steps, expected.steps + 3)

    def test_two_worlds_in_two_threads(self):
        worlds = [World(grains(), threads=k) for k in (1, 2, 1)]
        threads = [threading.Thread(target=world.step, args=(2000,)) for world in worlds[:2]]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        worlds[2].step(2000)
        for world in worlds[:2]:
            np.testing.assert_array_equal(world.r, worlds[2].r)

    def test_a_world_in_two_threads_is_refused(self):
        world = World(grains())
        refused = []

        is_done, is_running = threading.Event(), threading.Event()

        def wait(of):
            is_running.set()
            return is_done.is_set()

        def other():
            is_running.wait()
            try:
                for call in (lambda: world.r, lambda: world.step(), lambda: world.t, lambda: world.boundary(0).v):
                    try:
                        call()
                    except UsageError as error:
                        refused.append(str(error))
            finally:
                is_done.set()

        world.before_each_step(wait)
        thread = threading.Thread(target=other)
        thread.start()
        world.step(10**9)
        thread.join()
        self.assertEqual(len(refused), 4)
        for text in refused:
            self.assertRegex(text, r"^(World|Boundary)[.a-z]*: another thread is using this world$")
        self.assertTrue(np.isfinite(world.r).all())


def steps_in_child(make, queue):
    try:
        world = make()
        world.step(20)
        queue.put(world.r.sum())
    except Exception as error:
        queue.put(f"{type(error).__name__}: {error}")


class Processes(unittest.TestCase):
    def in_child(self, make):
        context = multiprocessing.get_context("fork")
        queue = context.Queue()
        child = context.Process(target=steps_in_child, args=(make, queue))
        child.start()
        result = queue.get(timeout=30)
        child.join()
        return result

    def test_forked_processes(self):
        before = World(grains(), threads=2)
        before.step(20)
        total = before.r.sum()
        text = self.in_child(lambda: before)
        self.assertEqual(text, "UsageError: World.step: the world was made before this process was forked; make it afterwards")
        self.assertRegex(self.in_child(lambda: World(grains(), threads=2)), "UsageError: World: this process was forked from one whose "
                         "worlds had several threads.*got threads=2")
        self.assertEqual(self.in_child(lambda: World(grains())), total)

    def test_threads_in_a_process_forked_before_any_world(self):
        code = f"""
import multiprocessing, sys
sys.path.insert(0, {os.path.dirname(os.path.abspath(__file__))!r})
from granular_steps_test import World, grains
def steps(threads):
    world = World(grains(), threads=threads)
    world.step(20)
    return world.r.sum()
with multiprocessing.get_context("fork").Pool(2) as pool:
    print(len(set(pool.map(steps, [1, 2]))))
"""
        done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.stdout, "1\n")


if __name__ == "__main__":
    unittest.main()
