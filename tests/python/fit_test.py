# SPDX-License-Identifier: GPL-3.0-or-later
"""hilda.fit against a closed form, its standard errors, and its refusals."""

import os
import signal
import tempfile
import threading
import time
import unittest

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import hilda

STIFFNESS, DAMPING, INERTIA, SPEED = 30.0, 0.5, 1.5, 2.0
# A wheel on a torsion spring
WHEEL = {"hilda_model": 1, "name": "wheel", "gravity": [0, 0, 0], "parameters": {"k": 20, "c": 0.2},
         "bodies": [{"name": "wheel", "mass": 1, "inertia": [1, INERTIA, 1], "r": [0, 0, 0], "omega": [0, SPEED, 0]}],
         "constraints": [{"type": "revolute", "name": "axle", "body_i": "ground", "body_j": "wheel", "axis_bar_i": [0, 1, 0],
                          "axis_bar_j": [0, 1, 0]}],
         "forces": [{"type": "torsion-spring", "name": "spring", "body_i": "ground", "body_j": "wheel", "axis_bar_i": [0, 1, 0],
                     "axis_bar_j": [0, 1, 0], "free_angle": 0, "stiffness": "k", "damping": "c"}]}
DECAY = DAMPING / (2 * INERTIA)
OMEGA = np.sqrt(STIFFNESS / INERTIA - DECAY**2)
T = np.linspace(0, 2, 41)
EXACT = np.sin(SPEED / OMEGA * np.exp(-DECAY * T) * np.sin(OMEGA * T))
BOTH = {"/parameters/k": None, "/parameters/c": (0.2, 0, 10)}


class Fits(unittest.TestCase):
    def test_exact_data(self):
        with self.assertWarnsRegex(hilda.SimulationWarning, "the time steps change /parameters/k by about") as warned:
            result = hilda.fit(WHEEL, {"t": T, "wheel.A13": EXACT}, BOTH, rtol=1e-11)
        self.assertEqual((str(warned.warning), warned.filename), (result.warnings[0], __file__))
        np.testing.assert_allclose(result.value, [STIFFNESS, DAMPING], rtol=1e-7)
        self.assertEqual(result["/parameters/k"], result.value[0])
        self.assertEqual(result.parameters, list(BOTH))
        self.assertTrue(result.converged)
        self.assertEqual(result.degrees_of_freedom, 39)
        np.testing.assert_allclose(result.fitted[:, 0], EXACT, atol=1e-8)
        run = result.model.run("rA-dop853", end=2, interval=0.05)  # the fitted model
        np.testing.assert_allclose(run["wheel"].A[:, 0, 2], EXACT, atol=1e-8)
        self.assertIn("/parameters/k", repr(result))
        axes = result.plot()
        self.assertEqual((axes.get_ylabel(), len(axes.get_lines())), ("wheel.A13", 2))
        plt.close("all")

    def test_standard_errors(self):
        noise = 1e-3 * np.random.default_rng(7).standard_normal(len(T))
        data = {"t": T, "wheel.A13": EXACT + noise}
        data["wheel.A13"][[3, 20]] = np.nan
        known = hilda.fit(WHEEL, data, BOTH, sigma=1e-3)
        unknown = hilda.fit(WHEEL, data, BOTH, jobs=2)
        self.assertEqual(unknown.degrees_of_freedom, 37)
        self.assertAlmostEqual(unknown.sigma, 1e-3, delta=4e-4)
        np.testing.assert_allclose(unknown.error, known.error * unknown.sigma / 1e-3, rtol=1e-6)
        np.testing.assert_allclose(np.sqrt(np.diag(known.covariance)), known.error, rtol=1e-12)
        self.assertTrue((abs(known.value - [STIFFNESS, DAMPING]) < 4 * known.error).all())
        self.assertTrue((known.interval[:, 0] < known.value).all() and (known.value < known.interval[:, 1]).all())
        self.assertEqual([row["parameter"] for row in known.rows()], list(BOTH))

    def test_the_scale_of_the_data_has_no_effect(self):
        noise = 1e-5 * np.random.default_rng(3).standard_normal(len(T))
        reference = hilda.fit(WHEEL, {"t": T, "wheel.A13": EXACT + noise}, BOTH)
        for scale in (1e-9, 1e-5, 1e9):
            model = {**WHEEL, "outputs": [{"type": "expression", "name": "y", "value": f"{scale}*wheel.A13"}]}
            result = hilda.fit(model, {"t": T, "y": scale * (EXACT + noise)}, BOTH)
            np.testing.assert_allclose(result.value, reference.value, rtol=1e-7)
            np.testing.assert_allclose(result.error, reference.error, rtol=1e-3)
        large = hilda.fit(WHEEL, {"t": T, "wheel.A13": EXACT + noise}, BOTH, sigma=1e9)
        np.testing.assert_allclose(large.value, reference.value, rtol=1e-7)

    def test_far_bounds(self):
        data = {"t": T, "wheel.A13": EXACT}
        for start in [{"/parameters/k": (10, 0, high), "/parameters/c": (0.2, 0, high)} for high in (1e3, 1e8, 1e15, 1e300)] + [
                {"/parameters/k": (2e-3, 1e-6, 1e6), "/parameters/c": (1e-6, 0, 1e4)}]:
            with self.assertWarnsRegex(hilda.SimulationWarning, "the time steps change"):
                result = hilda.fit(WHEEL, data, start)
            np.testing.assert_allclose(result.value, [STIFFNESS, DAMPING], rtol=1e-7)

    def test_close_instants(self):
        keep = np.array([0.1, 0.100000001, 0.5, 1.0])
        exact = np.sin(SPEED / OMEGA * np.exp(-DECAY * keep) * np.sin(OMEGA * keep))
        with self.assertWarnsRegex(hilda.SimulationWarning, "the interpolation of wheel.A13"):
            result = hilda.fit(WHEEL, {"t": keep, "wheel.A13": exact}, BOTH)
        np.testing.assert_allclose(result.value, [STIFFNESS, DAMPING], rtol=1e-3)
        with self.assertRaisesRegex(hilda.InvalidInput, "the column wheel.A13 is given twice"):
            hilda.fit(WHEEL, {"t": T, "wheel.A13": EXACT}, BOTH, columns=["wheel.A13", "wheel.A13"])

    def test_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "data.csv")
            np.savetxt(path, np.stack([T, EXACT], axis=1), delimiter=",", header="t,wheel.A13", comments="", fmt="%.17g")
            with self.assertWarnsRegex(hilda.SimulationWarning, "the time steps change"):
                result = hilda.fit(WHEEL, path, BOTH, "rA-rkmk-4", step=5e-3, columns=["wheel.A13"])
            np.testing.assert_allclose(result.value, [STIFFNESS, DAMPING], rtol=1e-4)
            self.assertTrue((abs(result.bias) > 0).all())
            with self.assertRaisesRegex(hilda.InvalidInput, "data.csv: has no column 'x'"):
                hilda.fit(WHEEL, path, BOTH, columns=["x"])

    def test_failures(self):
        data = {"t": T, "wheel.A13": EXACT}
        with self.assertRaisesRegex(hilda.NumericalFailure, "minimum was not reached in 1 iteration:") as caught:
            hilda.fit(WHEEL, data, BOTH, max_fit_iterations=1)
        self.assertEqual(caught.exception.status, "not_converged")
        self.assertEqual(caught.exception.fit.iterations, 1)
        for change, text in (({"data": {"t": T, "wheel.A": EXACT}}, "no column 'wheel.A'"),
                             ({"data": {"t": T, "wheel.A13": EXACT[1:]}}, r"shape \(41,\), got \(40,\)"),
                             ({"data": {"t": T, "wheel.A13": "x"}}, "must be an array of numbers"),
                             ({"data": {"wheel.A13": EXACT}}, "no column 't'"),
                             ({"parameters": {}}, "no parameter"),
                             ({"parameters": {"/parameters/k": (1, 2)}}, "must have start"),
                             ({"parameters": {"/parameters/k": "x"}}, "must have start.*got 'x'"),
                             ({"parameters": {"/parameters/k": float("nan")}}, "start must be a finite number, got nan"),
                             ({"parameters": {"/bodies/0/name": None}}, "no number there"),
                             ({"sigma": {"x": 1}}, "only one of them has"),
                             ({"sigma": -1}, "must be positive"),
                             ({"jobs": 0}, "must be positive, got 0"),
                             ({"rotl": 1}, "unknown keyword 'rotl'; did you mean 'rtol'"),
                             ({"source": hilda.Model(WHEEL)}, "got a Model"),
                             ({"integrator": "rA"}, "rA")):
            with self.subTest(text), self.assertRaisesRegex((hilda.UsageError, hilda.InvalidInput), text):
                hilda.fit(**{"source": WHEEL, "data": data, "parameters": BOTH, **change})

    def test_interrupt(self):
        data = {"t": T, "wheel.A13": EXACT}
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        start = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            while True:
                hilda.fit(WHEEL, data, BOTH, "rA-half-1", step=2e-6, jobs=2)
        timer.join()
        self.assertLess(time.monotonic() - start, 3)


if __name__ == "__main__":
    unittest.main()
