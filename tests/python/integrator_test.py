# SPDX-License-Identifier: GPL-3.0-or-later
"""Integrators in Python: their order, the equations of a system, errors."""

import gc
import unittest

import numpy as np

import hilda
from hilda import so3


class HalfImplicit(hilda.Integrator):
    """rA-half-1: half-implicit Euler with position constraints, Fang (2022), Sec. 3.5."""

    order = 1

    def step(self, x, h):
        system = self.system
        r, A = x.r.copy(), x.A.copy()
        J = system.inertia
        F, n_bar = system.loads(x)
        K = system.saddle(x)

        def momentum(v):
            return np.hstack([system.mass[:, None] * v[:, :3], np.einsum("bij,bj->bi", J, v[:, 3:])])

        v = np.hstack([x.rdot, x.omega_bar])
        gyroscopic = np.cross(v[:, 3:], momentum(v)[:, 3:])
        v, impulse = K.solve(momentum(v) + h * np.hstack([F, n_bar - gyroscopic]), system.nu(x))
        x.t += h
        for iteration in range(1, 31):
            x.r[:] = r + h * v[:, :3]
            x.A[:] = A @ so3.exp(h * v[:, 3:])
            dv, d_impulse = K.solve(0 * v, -system.phi(x) / h)
            v += dv
            impulse += d_impulse
            if h * np.linalg.norm(dv) < 1e-12:
                break
        x.rdot[:], x.omega_bar[:], x.lambda_[:] = v[:, :3], v[:, 3:], impulse / h
        return iteration


class RungeKutta(hilda.Integrator):
    """The classical Runge-Kutta method for the index-1 equations, projected onto the constraints."""

    order = 4

    def slope(self, x):
        self.system.set_accelerations(x)
        return np.array([x.rdot, x.omega_bar, x.rddot, x.omegadot_bar])

    def step(self, x, h):
        def at(c, k, theta):
            y = start.copy()
            y.t = x.t + c
            y.r[:] += c * k[0]
            y.A[:] = start.A @ so3.exp(theta)
            y.rdot[:] += c * k[2]
            y.omega_bar[:] += c * k[3]
            return y

        def theta_rate(theta, omega):  # the inverse of the right Jacobian up to the terms of order 4
            return omega + 0.5 * np.cross(theta, omega) + np.cross(theta, np.cross(theta, omega)) / 12

        start = x.copy()
        k = [self.slope(start.copy())]
        rate = [k[0][1]]
        for c in (h / 2, h / 2, h):
            theta = c * rate[-1]
            y = at(c, k[-1], theta)
            k.append(self.slope(y))
            rate.append(theta_rate(theta, k[-1][1]))
        mean = (k[0] + 2 * k[1] + 2 * k[2] + k[3]) / 6
        end = at(h, mean, h * (rate[0] + 2 * rate[1] + 2 * rate[2] + rate[3]) / 6)
        self.system.project(end)
        self.system.set_accelerations(end)
        for name in ("r", "A", "rdot", "omega_bar", "rddot", "omegadot_bar", "lambda_"):
            getattr(x, name)[...] = getattr(end, name)


def orders(integrator, steps, model, end):
    reference = model.run("rA-dop853", rtol=1e-13, end=end, interval=end).r[-1]
    errors = [np.linalg.norm(model.run(integrator, step=h, end=end, interval=end).r[-1] - reference) for h in steps]
    return errors, np.log2(np.array(errors[:-1]) / errors[1:])


class Integrators(unittest.TestCase):
    def test_the_order_of_a_scheme_is_that_of_its_twin(self):
        model = hilda.Model("n_pendulum_2_spin")
        steps = (2e-3, 1e-3, 5e-4)
        own, own_orders = orders(HalfImplicit, steps, model, 0.5)
        twin, twin_orders = orders("rA-half-1", steps, model, 0.5)
        np.testing.assert_allclose(own, twin, rtol=1e-6)
        np.testing.assert_allclose(own_orders, twin_orders, atol=1e-4)
        np.testing.assert_allclose(own_orders, 1, atol=0.1)

    def test_a_scheme_of_order_four(self):
        for name in ("double_pendulum_moving", "n_pendulum_2_spin"):
            with self.subTest(name):
                errors, measured = orders(RungeKutta, (2e-2, 1e-2, 5e-3), hilda.Model(name), 0.5)
                np.testing.assert_allclose(measured, 4, atol=0.3)

    def test_the_equations_of_a_system(self):
        model = hilda.Model("slider_crank")
        seen = []

        class Look(HalfImplicit):
            def step(self, x, h):
                if not seen:
                    system, y = self.system, x.copy()
                    system.set_accelerations(y)
                    C = system.jacobian(y).reshape(system.rows, -1)
                    v = np.hstack([y.rdot, y.omega_bar]).ravel()
                    a = np.hstack([y.rddot, y.omegadot_bar]).ravel()
                    seen.append([np.abs(system.phi(y)).max(), np.abs(C @ v - system.nu(y)).max(),
                                 np.abs(C @ a - system.gamma(y)).max()])
                    F, n_bar = system.loads(y)
                    J_omega = np.einsum("bij,bj->bi", system.inertia, y.omega_bar)
                    force = np.hstack([F, n_bar - np.cross(y.omega_bar, J_omega)]).ravel() - C.T @ y.lambda_
                    inertial = np.hstack([system.mass[:, None] * y.rddot,
                                          np.einsum("bij,bj->bi", system.inertia, y.omegadot_bar)]).ravel()
                    seen.append(np.abs(force - inertial).max())
                return super().step(x, h)

        model.run(Look, step=1e-3, end=0.01)
        self.assertLess(max(*seen[0], seen[1]), 1e-9)

    def test_errors(self):
        class Fails(hilda.Integrator):
            def step(self, x, h):
                if x.t > 0.05:
                    raise KeyError("no step")
                x.r[:] += h * x.rdot

        model = hilda.Model(name="free", gravity=[0, 0, 0]).body("b", mass=1, inertia=[1, 1, 1], r=[0, 0, 0], r_dot=[1, 0, 0])
        with self.assertRaises(KeyError) as raised:
            model.run(Fails, step=1e-2)
        self.assertIn("in the step from t = 0.06 s", raised.exception.__notes__)
        np.testing.assert_allclose(raised.exception.result.r[:, 0, 0], raised.exception.result.t, atol=1e-15)

        class Divides(hilda.Integrator):
            def step(self, x, h):
                x.r[:] = np.nan

        with self.assertRaisesRegex(hilda.NumericalFailure, "the position after the step is not finite"):
            model.run(Divides, step=1e-2)

        class Counts(hilda.Integrator):
            def step(self, x, h):
                return "many"

        with self.assertRaisesRegex(TypeError, "must return the number of its iterations, or None"):
            model.run(Counts, step=1e-2)

        class KeepsMatrix(hilda.Integrator):
            def step(self, x, h):
                K = self.system.saddle(x)
                self.system.set_accelerations(x)
                K.solve(np.zeros((1, 6)), np.zeros(0))

        with self.assertRaisesRegex(ValueError, "the saddle matrix of another state has been factored since"):
            model.run(KeepsMatrix, step=1e-2)
        with self.assertRaisesRegex(NotImplementedError, "Empty has no method step"):
            model.run(type("Empty", (hilda.Integrator,), {}), step=1e-2)
        with self.assertRaisesRegex(hilda.UsageError, "a class derived from hilda.Integrator, got <class 'int'>"):
            model.run(int)
        with self.assertRaisesRegex(hilda.UsageError, "no selected integrator uses --rtol"):
            model.run(Fails, rtol=1e-3)
        with self.assertRaisesRegex(hilda.InvalidInput, "without contacts as constraints"):
            hilda.Model("ball_in_bowl").run(Fails)

    def test_a_step_that_spoils_the_state_ends_the_run(self):
        class Spoils(HalfImplicit):
            def step(self, x, h):
                count = super().step(x, h)
                self.spoil(x, h)
                return count

        def spoiled(spoil):
            return type("Spoiled", (Spoils,), {"spoil": lambda self, x, h: spoil(x, h)})

        def scale(x, h):
            x.A[0] *= 1.001

        def reflect(x, h):
            x.A[0] = -x.A[0]

        def stretch_late(x, h):
            if x.t > 0.035:
                x.A[0, 0, 0] += 1e-3

        for spoil in (scale, reflect, stretch_late):
            for run in ("run", "Simulation"):
                with self.subTest(spoil=spoil.__name__, run=run):
                    with self.assertRaisesRegex(hilda.NumericalFailure, "after the step is not a rotation") as caught:
                        if run == "run":
                            hilda.Model("double_pendulum").run(spoiled(spoil), step=1e-2, end=0.1)
                        else:
                            hilda.Simulation(hilda.Model("double_pendulum"), spoiled(spoil), step=1e-2, end=0.1).advance(0.1)
                    self.assertEqual(caught.exception.status, "not_a_rotation")

        def late(x, h):
            x.t += h

        def nowhere(x, h):
            x.t = float("nan")

        for spoil in (late, nowhere):
            with self.assertRaisesRegex(ValueError, r"must leave x.t at 0 s or set it to 0.01 s, got"):
                hilda.Model("double_pendulum").run(spoiled(spoil), step=1e-2, end=0.1)

    def test_rotations(self):
        theta = np.array([[0.3, -0.2, 0.5], [0, 0, 0], [1e-9, 0, 0], [0, 3, 0]])
        A = so3.exp(theta)
        np.testing.assert_allclose(np.einsum("nki,nkj->nij", A, A), np.broadcast_to(np.eye(3), A.shape), atol=1e-15)
        np.testing.assert_allclose(A @ theta[..., None], theta[..., None], atol=1e-15)
        np.testing.assert_allclose(so3.exp([0, 0, np.pi / 2]) @ [1, 0, 0], [0, 1, 0], atol=1e-15)
        np.testing.assert_allclose(so3.tilde(theta[0]) @ [1, 2, 3], np.cross(theta[0], [1, 2, 3]))


class Lifetime(unittest.TestCase):
    def test_a_system_keeps_the_functions_of_its_model(self):
        """A force that refers to its model is part of a cycle, which the system still uses."""
        kept = []

        class Stored(hilda.Integrator):
            order = 1

            def __init__(self, system):
                super().__init__(system)
                kept.append(system)

            def step(self, x, h):
                x.t += h
                return 0

        def point():
            model = hilda.Model(name="point", gravity=[0, 0, 0], end=0.002)
            return model.body("point", mass=1, inertia=[1, 1, 1], r=[0, 0, 0], r_dot=[1, 0, 0])

        def cycle():
            model = point()

            def drag(x):
                return -0.1 * len(repr(model)[:1]) * x.rdot

            model.force(drag)
            model.run(Stored, step=1e-3)

        state = point().start.copy()
        cycle()
        gc.collect()
        F, n_bar = kept[0].loads(state)
        np.testing.assert_allclose(F, [[-0.1, 0, 0]])


if __name__ == "__main__":
    unittest.main()
