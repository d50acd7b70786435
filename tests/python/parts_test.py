# SPDX-License-Identifier: GPL-3.0-or-later
"""Constraints and surfaces written in Python, against closed forms and the parts of the library."""

import gc
import os
import threading
import unittest
import weakref

import numpy as np

import hilda


def cross(s):
    """The matrix of the cross product s x"""
    return np.array([[0, -s[2], s[1]], [s[2], 0, -s[0]], [-s[1], s[0], 0]])


def pendulum():
    """A bar of 1 m that turns about its end in three dimensions, without its joint"""
    model = hilda.Model(name="pendulum", gravity=[0, 0, -9.81], end=1)
    return model.body("bar", mass=2, inertia=[0.02, 1 / 6, 1 / 6], r=[0.5, 0, 0], r_dot=[0, 0.4, 0], omega=[3, 0, 0.8])


END = np.array([-0.5, 0, 0])


def joint(x):
    return x.r[0] + x.A[0] @ END - x.r[1]


def joint_variation(x):
    return (np.hstack([np.eye(3), -x.A[0] @ cross(END)]), np.hstack([-np.eye(3), np.zeros((3, 3))]))


def joint_gamma(x):
    return -x.A[0] @ np.cross(x.omega_bar[0], np.cross(x.omega_bar[0], END))


class Constraints(unittest.TestCase):
    def test_a_spherical_joint(self):
        reference = pendulum().constraint("spherical", body_i="bar", body_j="ground", s_bar_p_i=END, s_bar_q_j=[0, 0, 0])
        for keys, most in (({}, 2e-8), ({"variation": joint_variation}, 1e-9),
                           ({"variation": joint_variation, "gamma": joint_gamma, "nu": lambda x: np.zeros(3)}, 1e-11)):
            model = pendulum().constraint(joint, body_i="bar", body_j="ground", rows=3, **keys)
            self.assertEqual(model.report["degrees_of_freedom"], 3)
            for integrator in ("rA-half-1-momentum", "rA-half-2", "rA-rkmk-4", "rA-full-1", "rA-rattle"):
                with self.subTest(integrator, keys=list(keys)):
                    a = model.run(integrator, end=0.3, step=2e-3, reactions=True)
                    b = reference.run(integrator, end=0.3, step=2e-3, reactions=True)
                    np.testing.assert_allclose(a.r, b.r, atol=most)
                    np.testing.assert_allclose(a.omega_bar, b.omega_bar, atol=30 * most)
                    np.testing.assert_allclose(a.reaction_F, b.reaction_F, atol=3e4 * most)
                    self.assertLess(a.constraint_norm, 1e-9)

    def test_a_rope_over_two_pulleys(self):
        m_1, m_2, g = 2.0, 1.0, 9.81

        def rope(x):
            return [np.linalg.norm(x.r[0]) + np.linalg.norm(x.r[1] - [1, 0, 0]) - 4]

        model = hilda.Model(name="atwood", gravity=[0, 0, -g], end=0.5)
        model.body("heavy", mass=m_1, inertia=[1, 1, 1], r=[0, 0, -2]).body("light", mass=m_2, inertia=[1, 1, 1], r=[1, 0, -2])
        result = model.constraint(rope, body_i="heavy", body_j="light").run("rA-half-1-kick")
        a = g * (m_1 - m_2) / (m_1 + m_2)
        np.testing.assert_allclose(result["heavy"].r[:, 2], -2 - 0.5 * a * result.t**2, atol=1e-9)
        # the tension
        np.testing.assert_allclose(abs(result.lambda_[:, 0]), 2 * m_1 * m_2 * g / (m_1 + m_2), rtol=1e-7)

    def test_a_row_that_depends_on_time(self):
        """A point that moves on a given circle: the force is that of its acceleration."""
        def point(x):
            return x.r[0] - [np.cos(3 * x.t), np.sin(3 * x.t), 0]

        model = hilda.Model(name="point", gravity=[0, 0, 0], end=1)
        model.body("point", mass=2, inertia=[1, 1, 1], r=[1, 0, 0], r_dot=[0, 3, 0]).constraint(point, body_i="point", body_j="ground", rows=3)
        result = model.run("rA-rkmk-4", step=1e-2, reactions=True)
        expected = np.stack([np.cos(3 * result.t), np.sin(3 * result.t), 0 * result.t], axis=1)
        np.testing.assert_allclose(result["point"].r, expected, atol=1e-9)
        np.testing.assert_allclose(result["point"].reaction_F, -18 * expected, atol=1e-5)

    def test_differences_follow_small_lengths_and_short_times(self):
        """A bead on a circle, and a point that oscillates: positions, accelerations and forces"""
        for radius, speed, most in ((1.0, 1.0, 1e-8), (1e-3, 1.0, 1e-8), (1e-2, 0.1, 1e-8), (1e-4, 1.0, 1e-5)):
            turn = 2 * np.pi * radius / speed
            bead = hilda.Model(name="bead", gravity=[0, 0, 0], end=turn)
            bead.body("bead", mass=1, inertia=[1, 1, 1], r=[radius, 0, 0], r_dot=[0, speed, 0])
            bead.constraint(lambda x: [np.hypot(x.r[0, 0], x.r[0, 1]) - radius, x.r[0, 2]], name="circle", rows=2, body_i="bead", body_j="ground")
            result = bead.run("rA-dop853", interval=turn / 20)
            with self.subTest(radius=radius):
                np.testing.assert_allclose(result.r[-1, 0], [radius, 0, 0], atol=most * radius)
                np.testing.assert_allclose(abs(result.lambda_[:, 0]), speed**2 / radius, rtol=most)
        for omega in (1, 100, 1000):
            point = hilda.Model(name="point", gravity=[0, 0, 0], end=6 / omega)
            point.body("point", mass=1, inertia=[1, 1, 1], r=[0, 0, 0], r_dot=[0.01 * omega, 0, 0])
            point.constraint(lambda x: [x.r[0, 0] - 0.01 * np.sin(omega * x.t)], name="drive", body_i="point", body_j="ground")
            result = point.run("rA-dop853", interval=0.1 / omega)
            exact = -0.01 * omega**2 * np.sin(omega * result.t)
            np.testing.assert_allclose(result.rddot[:, 0, 0], exact, atol=1e-8 * 0.01 * omega**2)

        def rough(x):
            return [x.r[0, 0] - 1e-6 * abs(np.sin(1e5 * x.r[0, 1]))]

        bumpy = hilda.Model(name="bumpy", gravity=[0, 0, 0], end=1)
        bumpy.body("point", mass=1, inertia=[1, 1, 1], r=[0, 0, 0], r_dot=[0, 1, 0]).constraint(rough, body_i="point", body_j="ground")
        with self.assertRaises((hilda.NumericalFailure, hilda.InvalidInput)):
            bumpy.run()

    def test_given_functions_are_compared_with_differences(self):
        keys = {"variation": joint_variation, "gamma": joint_gamma, "nu": lambda x: np.zeros(3)}
        right = pendulum().constraint(joint, body_i="bar", body_j="ground", rows=3, **keys)
        self.assertEqual(right.warnings, [])
        for change, text in (({"gamma": lambda x: -joint_gamma(x)}, "constraint 'joint': gamma of row "),
                             ({"variation": lambda x: (2 * joint_variation(x)[0], joint_variation(x)[1])}, "C_i of row . is 2, by differences 1"),
                             ({"nu": lambda x: np.array([0, 0.5, 0])}, "nu of row 2 is 0.5, by differences 0")):
            wrong = pendulum().constraint(joint, body_i="bar", body_j="ground", rows=3, **{**keys, **change})
            try:
                warnings = wrong.warnings
            except hilda.InvalidInput as error:  # the start is not consistent with the wrong function
                warnings = [str(error)]
            self.assertRegex("; ".join(warnings), text + "|violate")

    def test_threads_start_a_model_once(self):
        errors = []

        def run(model):
            try:
                model.run(end=0.01)
            except Exception as error:
                errors.append(error)

        for _ in range(5):
            model = pendulum().constraint(joint, body_i="bar", body_j="ground", rows=3)
            threads = [threading.Thread(target=run, args=(model,)) for _ in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        self.assertEqual(errors, [])
        self.assertEqual((model.report["rows"], model.report["rank"]), (3, 3))

    def test_orders(self):
        model = pendulum().constraint(joint, body_i="bar", body_j="ground", rows=3, variation=joint_variation, gamma=joint_gamma)
        study = hilda.convergence(model, ["rA-half-1", "rA-half-1-kick"], [8e-3, 4e-3, 2e-3], end=0.24)
        np.testing.assert_allclose(study.order["r"][:, -1], [1, 2], atol=0.1)

    def test_errors(self):
        def model(phi=joint, **keys):
            return pendulum().constraint(phi, **{"body_i": "bar", "body_j": "ground", "rows": 3, **keys})

        for keys, kind, text in (({"rows": 2}, ValueError, r"phi must have the shape \(2,\), got \(3,\)"),
                                 ({"phi": lambda x: [0, np.nan, 0]}, ValueError, "phi is not finite: component 1 is nan"),
                                 ({"phi": lambda x: "x"}, TypeError, "phi must be an array of numbers, got str"),
                                 ({"phi": lambda x: [[1], [2, 3], 4]}, ValueError, "inhomogeneous shape"),
                                 ({"variation": lambda x: np.zeros((3, 6))}, TypeError, r"must return a tuple \(C_i, C_j\)"),
                                 ({"variation": lambda x: (np.zeros((3, 6)), np.zeros((3, 3)))}, ValueError, r"C_j must have the shape \(3, 6\), got \(3, 3\)"),
                                 ({"rows": 9}, hilda.InvalidInput, "rows must be from 1 to 8, got 9"),
                                 ({"body_j": "bar"}, hilda.InvalidInput, "the bodies must be different"),
                                 ({"body_j": "rod"}, hilda.InvalidInput, "constraint 'joint': .*rod"),
                                 ({"phi": lambda x: joint(x) + 1}, hilda.InvalidInput, "constraint")):
            with self.subTest(text), self.assertRaisesRegex(kind, text):
                model(**keys).run(end=0.01)
        repeated = model().constraint("spherical", name="pin", body_i="bar", body_j="ground", s_bar_p_i=END, s_bar_q_j=[0, 0, 0])
        with self.assertWarnsRegex(hilda.SimulationWarning, "constraint 'pin' row 1; .*dropped"):
            repeated.run(end=0.01)
        with self.assertRaisesRegex(hilda.UsageError, "constraint 'joint': unknown keys row"):
            model(row=3)
        with self.assertRaisesRegex(hilda.UsageError, "constraint 'joint': missing key 'body_j'"):
            pendulum().constraint(joint, body_i="bar")
        with self.assertRaisesRegex(hilda.UsageError, "constraint 'joint' is a function"):
            model().save(os.devnull)

        def fails(x):
            if x.t > 0.1:
                raise RuntimeError("here")
            return joint(x)

        with self.assertRaisesRegex(RuntimeError, "here") as raised:
            model(fails).run()
        self.assertRegex(raised.exception.__notes__[0], "phi of constraint 'fails' at t = 0.1")
        self.assertGreater(len(raised.exception.result), 50)

    def test_collection(self):
        def make():
            model = pendulum()
            model.constraint(lambda x: joint(x) if model else 0, body_i="bar", body_j="ground", rows=3)
            model.run(end=0.01)
            return weakref.ref(model)

        model = make()
        gc.collect()
        self.assertIsNone(model())


class Ball(hilda.Surface):
    """A sphere: G = (|a|^2/R - R)/2"""

    def __init__(self, R):
        self.R = self.size = R

    def value(self, a):
        return 0.5 * (a @ a / self.R - self.R)

    def gradient(self, a):
        return a / self.R


class ConvexBall(Ball):
    def hessian(self, a):
        return np.eye(3) / self.R

    def support(self, u):
        return self.R * u


def rolling(surface, **keys):
    model = hilda.Model(name="ball", gravity=[0, 0, -9.81], end=0.3)
    model.body("ball", mass=1, inertia=[0.004] * 3, r=[0, 0, 0.0999], r_dot=[0.3, 0, 0])
    return model.contact(name="floor", body_i="ball", body_j="ground", surface_i=surface, surface_j={"type": "plane"}, **keys)


COMPLIANT = {"normal": {"type": "hertz", "E_star": 1e6, "restitution": 0.5}}


class Surfaces(unittest.TestCase):
    def test_a_sphere_is_that_of_the_library(self):
        reference = rolling({"type": "sphere", "radius": 0.1}, **COMPLIANT).run(step=1e-4, columns="contacts")
        for surface, most in ((ConvexBall(0.1), 1e-9), ({"type": ConvexBall(0.1), "position": [0, 0, 0]}, 1e-9)):
            result = rolling(surface, **COMPLIANT).run(step=1e-4, columns="contacts")
            np.testing.assert_allclose(result.r, reference.r, atol=most)
            np.testing.assert_allclose(result.columns["floor.F_N"], reference.columns["floor.F_N"], atol=1e-4)
            self.assertGreater(result.columns["floor.F_N"].max(), 5)

    def test_rolling_as_a_constraint(self):
        """A ball in a bowl, with and without second derivatives"""
        def model(surface):
            ball = hilda.Model(name="bowl", gravity=[0, 0, -9.81], end=0.2)
            ball.body("ball", mass=1, inertia=[0.004] * 3, r=[0.3, 0, -np.sqrt(0.81 - 0.09)])
            return ball.contact(name="bowl", body_i="ball", body_j="ground", surface_i=surface,
                                surface_j={"type": "sphere", "radius": 1, "concave": True},
                                normal={"type": "constraint", "unilateral": False}, friction={"law": "rolling"})

        reference = model({"type": "sphere", "radius": 0.1}).run()
        self.assertGreater(abs(reference.r[-1] - reference.r[0]).max(), 0.02)
        for surface in (Ball(0.1), ConvexBall(0.1)):
            np.testing.assert_allclose(model(surface).run().r, reference.r, atol=1e-9)

    def test_errors(self):
        class Flat(hilda.Surface):
            size = 0.1

        with self.assertRaisesRegex(NotImplementedError, "Flat has no (value|gradient)"):
            rolling(Flat(), **COMPLIANT).run()

        class Wrong(ConvexBall):
            def gradient(self, a):
                return a[:2]

        class Flatter(ConvexBall):
            def hessian(self, a):
                return 0.5 * super().hessian(a)

        with self.assertWarnsRegex(hilda.SimulationWarning, r"surface 'Flatter': entry .* of the Hessian is 5, not 10"):
            rolling(Flatter(0.1), **COMPLIANT).run(end=0.01)

        with self.assertRaisesRegex(ValueError, r"gradient must have the shape \(3,\), got \(2,\)") as raised:
            rolling(Wrong(0.1), **COMPLIANT).run()
        self.assertIn("of the surface Wrong at [", raised.exception.__notes__[0])
        ball = ConvexBall(0.1)
        ball.size = -1
        with self.assertRaisesRegex(ValueError, "size must not be negative, got -1"):
            rolling(ball, **COMPLIANT).run()
        with self.assertRaisesRegex(hilda.UsageError, "the surface ConvexBall is written in Python"):
            rolling(ConvexBall(0.1), **COMPLIANT).save(os.devnull)
        with self.assertRaisesRegex(hilda.InvalidInput, "there is no surface with this number"):
            rolling({"type": "python", "number": 0}, **COMPLIANT).run()

    def test_collection(self):
        def make():
            ball = ConvexBall(0.1)
            ball.model = rolling(ball, **COMPLIANT)
            ball.model.run(end=0.01, step=1e-4)
            return weakref.ref(ball.model)

        model = make()
        gc.collect()
        self.assertIsNone(model())


if __name__ == "__main__":
    unittest.main()
