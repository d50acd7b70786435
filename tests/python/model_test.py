# SPDX-License-Identifier: GPL-3.0-or-later
"""Models in Python: files, construction, forces that are functions."""

import gc
import json
import os
import tempfile
import unittest
import weakref

import numpy as np

import hilda


def pendulum():
    model = hilda.Model(name="pendulum", end=1)
    model.body("bar", mass=2, inertia=np.array([1e-3, 1 / 6, 1 / 6]), r=[0.5, 0, 0])
    model.constraint("revolute", name="pin", body_i="ground", body_j="bar", s_bar_q_j=[-0.5, 0, 0],
                     axis_bar_i=[0, 1, 0], axis_bar_j=[0, 1, 0])
    return model


class Models(unittest.TestCase):
    def test_a_model_that_is_constructed_is_that_of_its_file(self):
        model = pendulum()
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "pendulum.json")
            model.save(path)
            np.testing.assert_array_equal(model.run().r, hilda.run(path).r)
        np.testing.assert_array_equal(model.run().r, hilda.run(model.to_dict()).r)
        self.assertEqual(model.report["degrees_of_freedom"], 1)
        self.assertEqual(model.bodies, ["bar"])

    def test_changes(self):
        light = hilda.Model(pendulum().to_dict(), set={"/bodies/0/mass": 1})
        self.assertEqual(light.to_dict()["bodies"][0]["mass"], 1)
        with self.assertRaisesRegex(hilda.InvalidInput, "/bodies/3"):
            hilda.Model("double_pendulum", set={"/bodies/3/mass": 1}).report

    def test_a_model_can_be_extended(self):
        model = hilda.Model("double_pendulum")
        before = model.run(end=1).energy
        model.force("spring-damper", body_i="ground", body_j=model.bodies[1], stiffness=10, damping=1, free_length=0.1)
        after = model.run(end=1)
        self.assertLess(after.energy[-1], after.energy[0] - 10 * np.ptp(before))

    def test_arrays_are_copied_when_they_are_given(self):
        r = np.zeros(3)
        model = hilda.Model(name="three")
        for k in range(3):
            r[0] += 1
            model.body(f"b{k}", mass=np.float64(1), inertia=np.ones(3), r=r)
        self.assertEqual([body["r"][0] for body in model.to_dict()["bodies"]], [1, 2, 3])
        again = hilda.Model({**model.to_dict(), "gravity": np.zeros(3)}, set={"/bodies/0/mass": np.int64(2)})
        self.assertEqual(again.to_dict()["bodies"][0]["mass"], 2)
        with self.assertRaisesRegex(hilda.InvalidInput, "a model cannot contain a complex"):
            hilda.Model(name="m").body("b", mass=1j)

    def test_a_file_with_parameters_can_be_extended(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "p.json")
            content = pendulum().to_dict()
            content["parameters"] = {"m": 4}
            content["bodies"][0]["mass"] = "m"
            with open(path, "w", encoding="utf-8") as file:
                json.dump(content, file)
            model = hilda.Model(path, set={"/parameters/m": 5}).force("force", body="bar", frame="global",
                                                                      components=[0, 0, "m"])
            self.assertEqual(model.to_dict()["bodies"][0]["mass"], 5)
            self.assertEqual(model.run().status, "ok")

    def test_errors_have_their_place(self):
        for change, text in (({"mass": -1}, r"/bodies/0/mass\): mass must be positive, got -1"),
                             ({"inertia": [1, 1]}, "/bodies/0/inertia"),
                             ({"masss": 1}, "masss.*did you mean 'mass'")):
            body = {"mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0], **change}
            with self.subTest(**change), self.assertRaisesRegex(hilda.InvalidInput, text):
                hilda.Model(name="m").body("b", **body).report
        with self.assertRaisesRegex(hilda.InvalidInput, "slider_crank"):
            hilda.Model("slider_crnk").report
        with self.assertRaises(hilda.InvalidInput):
            hilda.Model("missing/model.json").report
        with self.assertRaisesRegex(hilda.UsageError, "the keys gravity are for a new model"):
            hilda.Model("double_pendulum", gravity=[0, 0, 0])

    def test_lists(self):
        self.assertIn("rA-half-1-momentum", hilda.integrators())
        self.assertEqual(hilda.integrators()["rA-rkmk-4"]["order"], 4)
        self.assertEqual(hilda.integrators()["rA-rkmk-4"]["supports"], ["contacts", "rolling", "redundant_rows", "history"])
        self.assertIn("ida-rp", hilda.integrators())
        self.assertIn("slider_crank", hilda.problems())


class Forces(unittest.TestCase):
    def test_a_function_is_the_force_that_it_computes(self):
        k = 30.0
        built_in = pendulum().force("force", body="bar", frame="global", components=[0, 0, "3*t"]).run()
        function = pendulum().force(lambda x: [[0, 0, 3 * x.t]]).run()
        np.testing.assert_allclose(function.r, built_in.r, atol=1e-13)

        def spring(x):
            return -k * x.r

        model = pendulum().force(spring, potential=lambda x: 0.5 * k * (x.r ** 2).sum())
        energy = model.run("rA-dop853", rtol=1e-12).energy
        self.assertLess(np.ptp(energy), 1e-9)

    def test_torques(self):
        model = pendulum().force(lambda x: (np.zeros((1, 3)), -0.2 * x.omega_bar))
        energy = model.run().energy
        self.assertLess(energy[-1], energy[0] - 1e-3)

    def test_the_order_of_an_integrator_with_a_force_that_is_a_function(self):
        model = pendulum().force(lambda x: -0.5 * np.linalg.norm(x.rdot) * x.rdot)
        reference = model.run("rA-dop853", rtol=1e-13, interval=1).r[-1]
        errors = [np.linalg.norm(model.run(step=h, interval=1).r[-1] - reference) for h in (4e-3, 2e-3, 1e-3)]
        orders = np.log2(np.array(errors[:-1]) / errors[1:])
        np.testing.assert_allclose(orders, 2, atol=0.1)

    def test_bad_values_name_the_force_and_the_time(self):
        for value, kind, text in ((np.zeros((2, 3)), ValueError, r"F must have the shape \(1, 3\), got \(2, 3\)"),
                                  (np.zeros(3), ValueError, r"F must have the shape \(1, 3\), got \(3,\)"),
                                  (np.full((1, 3), np.nan), ValueError, r"F of body 0 is not finite: \[nan, nan, nan\]"),
                                  ("abc", TypeError, "F must be an array of numbers, got str"),
                                  (np.ones((1, 3), complex), TypeError, "F must be an array of numbers, got complex128"),
                                  (None, (TypeError, ValueError), "F must"),
                                  ((1, 2, 3), ValueError, r"must return F or \(F, n_bar\), got a tuple of 3")):
            model = pendulum().force(lambda x: value if x.t > 0.1 else np.zeros((1, 3)), name="bad")
            with self.subTest(value=value), self.assertRaisesRegex(kind, text) as raised:
                model.run()
            self.assertIn("the function of force 'bad' at t = 0.10", raised.exception.__notes__[0])
            self.assertGreater(len(raised.exception.result), 50)

    def test_arrays_of_other_types_and_layouts(self):
        expected = pendulum().force(lambda x: np.array([[1.0, 0, 2]])).run().r
        for value in (np.array([[1, 0, 2]], dtype=np.int32), np.array([[1, 9, 0, 9, 2]], dtype=float)[:, ::2], [[1, 0, 2]],
                      np.asfortranarray([[1.0, 0, 2]], dtype=np.float32)):
            np.testing.assert_array_equal(pendulum().force(lambda x: value).run().r, expected)

    def test_a_model_whose_function_refers_to_it_is_collected(self):
        def make():
            model = pendulum()
            model.force(lambda x: 0 * x.r if model else x.r)
            model.run(end=0.01)
            return weakref.ref(model)

        model = make()
        gc.collect()
        self.assertIsNone(model())

    def test_a_function_that_uses_its_model_at_the_start_is_refused(self):
        model = pendulum()
        model.force(lambda x: len(model.bodies) * x.r)
        with self.assertRaisesRegex(hilda.UsageError, "must not use the properties of its model while"):
            model.run()

    def test_a_function_is_not_written_to_a_file(self):
        with self.assertRaisesRegex(hilda.UsageError, "force 'drag' is a function"):
            pendulum().force(lambda x: x.r, name="drag").save(os.devnull)


if __name__ == "__main__":
    unittest.main()
