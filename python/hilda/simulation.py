# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulations whose loop is in the program of the user."""

from __future__ import annotations

import contextlib
from typing import Any

from numpy import float64
from numpy.typing import ArrayLike, NDArray

from . import _hilda
from ._hilda import State
from .errors import NumericalFailure, SimulationWarning
from .integrator import Integrator
from .model import Model, Source, _used
from .result import Events
from .settings import settings_as_text
from .warn import warn


class Simulation:
    """A run of a model that is advanced step by step, with the checks of Model.run() and the same positions::

        sim = hilda.Simulation("double_pendulum", end=2)
        while sim.step():
            print(sim.t, sim.state.r)

    Args:
        model: a Model, or what Model() takes. It does not change: several simulations may have the same one.
        integrator, step, end, force, and settings: those of Model.run().
        interval: time from node to node [s] of an integrator with adaptive steps; default: end/1000. It chooses its own
            steps between two nodes. Fixed steps have no interval.

    `step` computes the next node, `advance` several. A model with events is searched for them: an event with the action
    stop ends the run. An event is found in the step after the one in which it happens, because only then all values of
    the node after it are known.

    Warnings of the steps follow the call that finds them. If a filter makes errors of them, the node is computed, and the
    simulation can continue.

    Ctrl-C ends a call between two steps with KeyboardInterrupt. An exception of a function of the model is raised by the
    call. In both cases the simulation remains at its node and can continue.

    Raises:
        InvalidInput, UsageError: as Model.run().
        NumericalFailure: of a step, with its time, step and integrator. The simulation has then ended: `step`, `advance`,
            `set_loads` and `checkpoint` raise UsageError. `restore` continues from an earlier node.
    """

    def __init__(self, model: Model | Source, integrator: str | type[Integrator] | None = None, *,
                 step: float | None = None, end: float | None = None, interval: float | None = None, rtol: float | None = None,
                 atol: float | None = None, max_step: float | None = None, tolerance: float | None = None,
                 max_iterations: int | None = None, linear_solver: str | None = None, rho_infinity: float | None = None,
                 reparametrise: bool = False, force: bool = False, **settings: Any) -> None:
        self.model = model if isinstance(model, Model) else Model(model)
        core = self.model._core()
        settings.update(tolerance=tolerance, max_iterations=max_iterations, linear_solver=linear_solver,
                        rho_infinity=rho_infinity, rtol=rtol, atol=atol, max_step=max_step, reparametrise=reparametrise)
        self._core = _hilda._Simulation(core, _used("Simulation", core, integrator), end, step, interval,
                                        settings_as_text("Simulation", ("integrator", "step", "end", "interval", "force"),
                                                         settings),
                                        force, warn)

    def step(self) -> bool:
        """Computes the next node. Returns whether it has computed one: False at the end, and after an event that ends the run.

        The call that returns False checks the last node, and searches it for events.
        """
        try:
            more = self._core.step()
        except NumericalFailure:
            self._warn_of_failure()
            raise
        self._warn()
        return more

    def advance(self, t: float) -> bool:
        """Computes the nodes up to the time t [s]. Returns whether it is reached: False after an event that ends the run.

        At the end of the run the last node is checked and searched for events, as by the last call of step(). t must be a
        node: a multiple of the step, or of the interval of adaptive steps, up to rounding. UsageError otherwise.
        """
        try:
            reached = self._core.advance(t)
        except NumericalFailure:
            self._warn_of_failure()
            raise
        self._warn()
        return reached

    def _warn_of_failure(self) -> None:
        """The warnings before a failure, which is raised even if a filter makes errors of them"""
        with contextlib.suppress(SimulationWarning):
            self._warn()

    def _warn(self) -> None:
        for text in self._core.new_warnings():
            warn(text)

    @property
    def state(self) -> State:
        """A copy of the state at the present node, which may be kept. Its arrays are read-only.

        Integrators of the families rA-half-1, rA-half-2, rp-half-1 and reps-half-1 compute the multipliers and accelerations of
        a node in the step that begins there. Until then the state has those of the step before, and those of leapfrog extrapolate
        the velocities from the last two half steps; complete_state() has those of the node, with which Model.run()
        writes its rows. After an event that has ended the run, the state is that of the event.
        """
        return self._core.state

    def complete_state(self) -> State:
        """The state with the velocities, accelerations and multipliers of the present node, as an observer of Model.run()
        receives it if the loads remain.

        Integrators that compute them in the next step, see `state`, take an additional step, which does not change the
        simulation. If that step fails, the values are those of `state`, and so will the next step.
        """
        return self._core.complete_state()

    @property
    def t(self) -> float:
        """Time of the present node [s]."""
        return self._core.t

    @property
    def end(self) -> float:
        """End of the run [s]."""
        return self._core.end

    @property
    def interval(self) -> float:
        """Time from node to node [s]: the step, or the interval of adaptive steps."""
        return self._core.interval

    @property
    def integrator(self) -> str:
        """Name of the integrator."""
        return self._core.integrator

    @property
    def status(self) -> str:
        """One of "running", "ok" after the end, "stopped" after an event, and that of a NumericalFailure."""
        return self._core.status

    @property
    def stopped_by(self) -> str | None:
        """Name of the event that ended the run, or None."""
        return self._core.stopped_by

    @property
    def statistics(self) -> dict[str, int]:
        """Numbers of steps, iterations and factorisations, also of the steps before a checkpoint."""
        return self._core.statistics

    @property
    def warnings(self) -> list[str]:
        """Warnings of the model, of the checks before the run, and of the steps up to now. Each kind is reported once as
        SimulationWarning, by the call that finds it."""
        return self._core.warnings

    @property
    def events(self) -> Events:
        """The events of the model that were found up to now."""
        return Events(self._core.events(), self._core.event_names)

    def set_loads(self, F: ArrayLike | None = None, n_bar: ArrayLike | None = None) -> None:
        """Sets loads on the bodies, from the present node on, until they are set again.

        Args:
            F: forces at the centres of mass [N], global frame; shape (bodies, 3). None: zero.
            n_bar: torques [N m], body frames; shape (bodies, 3). None: zero.

        Both are replaced by each call.

        They are constant during a step, and act in addition to the loads of the model, for this simulation only. They have
        no potential energy; a run with them is not checked for a rise of its energy.

        The Runge-Kutta methods (rA-rkmk-4, rA-dp-5, rA-dop853, rA-radau-5) and the integrators rA-rattle and rA-rattle-N
        follow changes at the nodes without an additional error. Others shift a change by up to half a step: an error of the order
        of the step. Values of a smooth function that are sampled at the nodes have an error of order 1 with the first group,
        which sampling at the middle of the coming step avoids, and of order 2 with leapfrog. Integrators with adaptive steps
        start again at the node of a change.

        A load that follows the velocity, such as F = -c v, is one step late: the motion is stable for h c/m below 2, and
        below 1 with the leapfrog schemes rA-half-1-kick and rA-half-1-momentum. No check finds an unstable controller.

        At the start, and for integrators that do not compute the multipliers of a node in the next step (see `state`), the
        accelerations and multipliers of `state` follow the loads at once.

        Raises NumericalFailure, with the loads unchanged, if there are no accelerations for the loads, ValueError and TypeError
        for other shapes and numbers that are not finite, and UsageError after the end and for an
        integrator that stores past steps outside of the state: ida-rp and classes in Python.
        """
        self._core.set_loads(F, n_bar)

    @property
    def loads(self) -> tuple[NDArray[float64], NDArray[float64]]:
        """The loads that are set: copies of F and n_bar."""
        return self._core.loads

    def checkpoint(self) -> bytes:
        """The simulation at the present node, for restore(): its state, loads, counters, warnings and events.

        Raises UsageError for an integrator that stores past steps outside of the state, and after an event or a failure has
        ended the run.
        """
        return self._core.checkpoint()

    def restore(self, data: bytes) -> None:
        """Continues from a checkpoint of this simulation, or of another one with the same model, integrator, settings and step.
        The end may differ; adaptive steps then need the same `interval`, whose default is end/1000. The steps
        have the digits of a run without the interruption.

        Functions of the model are compared by their names: they must be the same, and any data that they hold are not part of
        the checkpoint.

        Raises UsageError for a checkpoint of another run, and FileError for data that are damaged.
        """
        self._core.restore(data)

    def __repr__(self) -> str:
        return f"<hilda.Simulation {self.model.name}, {self.integrator}: t = {self.t:g} s, status {self.status}>"
