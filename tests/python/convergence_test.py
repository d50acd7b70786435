# SPDX-License-Identifier: GPL-3.0-or-later
"""Orders of convergence in Python."""

import unittest

import matplotlib
import numpy as np

import hilda

matplotlib.use("Agg")


class Orders(unittest.TestCase):
    def test_the_orders_of_schemes_are_the_declared_ones(self):
        names = ["rA-half-1", "rA-half-1-momentum", "rA-rkmk-4"]
        study = hilda.convergence("n_pendulum_2_spin", names, [4e-3, 1e-3, 2e-3], end=0.5)
        self.assertEqual(study.steps, [4e-3, 2e-3, 1e-3])
        for i, name in enumerate(names):
            declared = hilda.integrators()[name]["order"]
            for quantity in ("r", "A", "v", "omega"):
                with self.subTest(name, quantity=quantity):
                    orders = study.order[quantity][i]
                    above_floor = np.isfinite(orders)
                    self.assertTrue(above_floor[0])
                    np.testing.assert_allclose(orders[above_floor], declared, atol=0.15)
        self.assertEqual(len(study.rows()), 9)
        self.assertEqual(study.rows()[4]["integrator"], "rA-half-1-momentum")
        self.assertIn("rA-rkmk-4", repr(study))
        self.assertEqual(len(study.plot("v").lines), 3)

    def test_errors_at_the_floor_have_no_order(self):
        study = hilda.convergence("double_pendulum", ["rA-rkmk-4"], [1e-3, 5e-4, 2.5e-4], end=0.1)
        self.assertTrue(np.isnan(study.order["r"][0, -1]))
        self.assertLess(study.error["r"][0, -1], 10 * study.floor["r"] + 1e-13)

    def test_a_failed_run_is_reported(self):
        study = hilda.convergence("double_pendulum_moving", ["rA-rattle"], [0.4, 1e-3], end=2)
        self.assertTrue(np.isnan(study.error["r"][0, 0]) and np.isfinite(study.error["r"][0, 1]))
        self.assertIn("rA-rattle at h = 0.4 s: ", study.failures[0])

    def test_the_end_need_not_be_a_multiple_of_the_instants(self):
        study = hilda.convergence("double_pendulum", ["rA-rattle"], [4e-3, 2e-3], end=0.5, instants=7)
        np.testing.assert_allclose(study.order["r"], 2, atol=0.1)

    def test_bad_input(self):
        for steps, keys, text in (([1e-3], {}, "needs two steps or more"), ([3e-3, 2e-3], {}, "must be a multiple of each step, got 0.002"),
                                  ([1e-3, 0], {}, "positive and finite"), ([1e-3, 1e-3], {}, "a step is given twice"),
                                  ([2e-3, 1e-3], {"end": 1e-4}, "must be at least the largest step"),
                                  ([2e-3, 1e-3], {"instants": 0}, "instants must be positive, got 0")):
            with self.subTest(steps=steps, **keys), self.assertRaisesRegex(hilda.UsageError, text):
                hilda.convergence("double_pendulum", ["rA-rattle"], steps, **keys)
        with self.assertRaisesRegex(hilda.UsageError, "the quantity must be one of r, A, v, omega, got 'x'"):
            hilda.convergence("double_pendulum", ["rA-rattle"], [4e-3, 2e-3], end=0.1).plot("x")


if __name__ == "__main__":
    unittest.main()
