# SPDX-License-Identifier: GPL-3.0-or-later
"""Integrators in Python."""

from __future__ import annotations

from ._hilda import State, System


class Integrator:
    """Base class of an integrator with a fixed step. A run makes an object of it: run(MyIntegrator, step=1e-3).

    Attributes:
        order: declared order; set it in the class.
        system: the System of the model.
    """

    order = 1

    def __init__(self, system: System) -> None:
        self.system = system

    def step(self, x: State, h: float) -> int | None:
        """Changes the arrays of x from t_n to t_n + h. x.t is t_n; the run sets the time afterwards.

        Returns the number of iterations, or None. An exception ends the run at t_n.
        """
        raise NotImplementedError(f"{type(self).__name__} has no method step(x, h)")
