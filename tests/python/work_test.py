# SPDX-License-Identifier: GPL-3.0-or-later
"""Error and computing time of integrators in Python."""

import unittest

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import hilda


class Work(unittest.TestCase):
    def test_errors_are_those_of_convergence(self):
        names, steps = ["rA-half-1-kick", "rA-rkmk-4"], [4e-3, 2e-3, 1e-3]
        work = hilda.work_precision("n_pendulum_2_spin", names, steps, end=0.48, instants=30)
        orders = hilda.convergence("n_pendulum_2_spin", names, steps, end=0.48, instants=30)
        for name in ("r", "A", "v", "omega"):
            np.testing.assert_allclose(work.error[name], orders.error[name], rtol=1e-12)
        self.assertEqual(work.is_adaptive, [False, False])
        self.assertTrue(all((seconds > 0).all() for seconds in work.seconds))

    def test_tolerances_and_needed_times(self):
        work = hilda.work_precision("n_pendulum_2_spin", ["rA-half-1-kick", "rA-dop853"], [4e-3, 1e-3], [1e-6, 1e-9], end=0.48)
        self.assertEqual(work.resolution, [[4e-3, 1e-3], [1e-6, 1e-9]])
        for i, name in enumerate(work.integrators):
            errors, seconds = work.error["r"][i], work.seconds[i]
            self.assertLess(errors[1], errors[0])
            middle = work.needed(np.sqrt(errors[0] * errors[1]))[name]
            self.assertAlmostEqual(middle, np.sqrt(seconds[0] * seconds[1]))
            self.assertTrue(np.isnan(work.needed(10 * errors[0])[name]))
        self.assertEqual([row["integrator"] for row in work.rows()], ["rA-half-1-kick"] * 2 + ["rA-dop853"] * 2)
        self.assertIn("rA-dop853", repr(work))
        self.assertEqual(len(work.plot("omega").lines), 2)
        plt.close("all")

    def test_failures(self):
        work = hilda.work_precision("double_pendulum_moving", ["rA-rattle"], [0.4, 1e-3], end=2, instants=5, repeats=1)
        self.assertTrue(np.isnan(work.error["r"][0][0]) and np.isfinite(work.error["r"][0][1]))
        self.assertIn("rA-rattle with step 0.4: ", work.failures[0])
        for integrators, keys, text in ((["rA-rattle"], {}, "rA-rattle needs steps"), ([], {"steps": [1]}, "no integrator"),
                                        (["rA-rattle"], {"steps": [0]}, "steps must be positive and finite"),
                                        (["rA-rattle"], {"steps": [3e-3]}, "must be a multiple of each step, got 0.003 s"),
                                        (["rA-rattle"], {"steps": [1e-3], "repeats": 0}, "positive, got 30 and 0")):
            with self.subTest(text), self.assertRaisesRegex(hilda.UsageError, text):
                hilda.work_precision("double_pendulum", integrators, end=1, **keys)
        with self.assertRaisesRegex(hilda.UsageError, "quantity must be one of"):
            work.plot("x")


if __name__ == "__main__":
    unittest.main()
