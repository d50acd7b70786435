# SPDX-License-Identifier: GPL-3.0-or-later
"""hilda.sweep against closed forms, and its refusals."""

import unittest

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import hilda

BALL = {"hilda_model": 1, "name": "ball", "gravity": [0, 0, -10], "end": 1, "bodies": [
    {"name": "ball", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0], "r_dot": [1, 0, 0]}]}


class Sweeps(unittest.TestCase):
    def test_thrown_balls(self):
        speeds, heights = [1, 2, 5], [0, 0.5]
        for jobs in (1, 2):
            sweep = hilda.sweep(BALL, {"/bodies/0/r_dot/0": speeds, "/bodies/0/r/2": heights},
                                {"x": lambda r: r.r[-1, 0, 0], "z": lambda r: r.r[-1, 0, 2]}, step=1e-2, jobs=jobs)
            np.testing.assert_allclose(sweep.measured["x"], np.array(speeds)[:, None] * np.ones(2), rtol=1e-12)
            np.testing.assert_allclose(sweep.measured["z"], np.array(heights) - 5 + np.zeros((3, 1)), rtol=1e-9)
            self.assertEqual(sweep.rows()[1], {"/bodies/0/r_dot/0": 1, "/bodies/0/r/2": 0.5, "x": sweep.measured["x"][0, 1],
                                               "z": sweep.measured["z"][0, 1]})
        self.assertIn("6 runs", repr(sweep))
        axes = sweep.plot("z")
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel(), len(axes.get_lines())), ("/bodies/0/r_dot/0", "z", 2))
        plt.close("all")

    def test_a_failed_run_is_a_missing_number(self):
        # The bars turn faster with time: four iterations are too few in the longer run.
        sweep = hilda.sweep("double_pendulum", {"/end": [0.05, 2.0]}, {"t": lambda r: r.t[-1]}, "rA-half-1", step=5e-2,
                            max_iterations=4)
        np.testing.assert_array_equal(np.isnan(sweep.measured["t"]), [False, True])
        self.assertEqual(len(sweep.failures), 1)
        self.assertIn("/end = 2.0: ", sweep.failures[0])
        self.assertIn(sweep.failures[0], repr(sweep))

    def test_refusals(self):
        last = {"x": lambda r: r.r[-1, 0, 0]}
        with self.assertRaisesRegex(hilda.InvalidInput, "nothing|there is no"):
            hilda.sweep(BALL, {"/bodies/0/nothing/1": [1]}, last)
        for grid, measure, keys, text in (({}, last, {}, "one value or more"), ({"/end": []}, last, {}, "one value or more"),
                                          ({"/end": [1]}, {}, {}, "no function"), ({"/end": [1]}, last, {"jobs": 0}, "positive, got 0")):
            with self.assertRaisesRegex(hilda.UsageError, text):
                hilda.sweep(BALL, grid, measure, **keys)
        with self.assertRaisesRegex(hilda.UsageError, "got a Model"):
            hilda.sweep(hilda.Model(BALL), {"/end": [1]}, last)
        with self.assertRaises(ZeroDivisionError):  # of the caller's function
            hilda.sweep(BALL, {"/end": [0.1]}, {"x": lambda r: 1 / 0}, step=1e-2)
        with self.assertRaisesRegex(hilda.UsageError, "must be one of x, got 'y'"):
            hilda.sweep(BALL, {"/end": [0.1]}, last, step=1e-2).plot("y")


if __name__ == "__main__":
    unittest.main()
