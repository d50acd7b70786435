# SPDX-License-Identifier: GPL-3.0-or-later
"""Results of runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy import bool_, float64
from numpy.typing import NDArray

from .tables import new_axes

if TYPE_CHECKING:
    from . import _hilda


class Motions:
    """The arrays of all bodies, or of one."""

    t: NDArray[float64]
    r: NDArray[float64]
    rdot: NDArray[float64]
    rddot: NDArray[float64]
    A: NDArray[float64]
    omega_bar: NDArray[float64]
    omegadot_bar: NDArray[float64]
    reaction_F: NDArray[float64] | None
    reaction_T: NDArray[float64] | None


class Result(Motions):
    """The rows of a run. Arrays have the time as first index, and are not copied.

    Attributes:
        t: times [s]; shape (n,).
        r, rdot, rddot: positions, velocities and accelerations of the centres of mass, global frame
            [m, m/s, m/s^2]; shape (n, bodies, 3).
        A: rotation matrices from the body frames to the global frame; shape (n, bodies, 3, 3).
        omega_bar, omegadot_bar: angular velocities and accelerations, body frames [rad/s, rad/s^2]; shape
            (n, bodies, 3).
        lambda_: multipliers of the constraint rows; shape (n, rows).
        energy: kinetic and potential energy [J]; shape (n,).
        reaction_F, reaction_T: with reactions=True, constraint forces [N, global frame] and torques
            [N m, body frame] on each body; shape (n, bodies, 3). Otherwise None.
        columns: the further columns of the run by their names; shape (n,).
        events: what was found of the events of the model.
        bodies: names of the bodies.
        model, integrator: their names.
        step: step [s], None with adaptive steps.
        status: "ok", "stopped" (by the observer or an event), "interrupted", "error" or that of a NumericalFailure.
        stopped_by: name of the event that ended the run, or None.
        t_end: time reached [s].
        statistics: numbers of steps, iterations and factorisations.
        seconds: CPU time of the steps, with their observers [s].
        constraint_norm: largest scaled residual of the constraints in all nodes [m or rad].
        warnings: warnings of the model and of the run.
    """

    lambda_: NDArray[float64]
    energy: NDArray[float64]
    integrator: str
    step: float | None
    status: str
    t_end: float
    stopped_by: str | None
    seconds: float
    columns: dict[str, NDArray[float64]]
    events: Events
    statistics: dict[str, int]
    constraint_norm: float
    warnings: list[str]

    def __init__(self, core: _hilda._Model, outcome: dict[str, Any]) -> None:
        rows = outcome["rows"]
        self.reaction_F = self.reaction_T = None
        arrays = outcome["arrays"]
        values = arrays.pop("columns", None)
        self.columns = {name: values[:rows, k] for k, name in enumerate(outcome["columns"])}
        for name, array in arrays.items():
            setattr(self, name, array[:rows])
        self.events = Events(outcome["events"], outcome["event_names"])
        self.bodies = core.bodies
        self.model = core.name
        for name in ("integrator", "step", "status", "stopped_by", "t_end", "seconds", "statistics", "constraint_norm", "warnings"):
            setattr(self, name, outcome[name])

    def __len__(self) -> int:
        return len(self.t)

    def __getitem__(self, body: str | int) -> BodyResult:
        """The rows of one body, by its name or number."""
        number = self.index(body)
        return BodyResult(self, number, self.bodies[number])

    def index(self, body: str | int) -> int:
        """Number of a body in the arrays."""
        if isinstance(body, str):
            if body not in self.bodies:
                raise KeyError(f"no body '{body}'; the bodies are {', '.join(self.bodies)}")
            return self.bodies.index(body)
        return range(len(self.bodies))[body]

    def plot(self, body: str | int = -1, axes: Any = None) -> Any:
        """Draws x, y and z of a body over time. Returns the matplotlib axes."""
        axes = new_axes() if axes is None else axes
        number = self.index(body)
        for component, name in enumerate("xyz"):
            axes.plot(self.t, self.r[:, number, component], label=name)
        axes.set_xlabel("t [s]")
        axes.set_ylabel(f"position of {self.bodies[number]} [m]")
        axes.set_title(f"{self.model}, {self.integrator}")
        axes.legend()
        return axes

    def __repr__(self) -> str:
        count = len(self.warnings)
        found = f", {count} warning{'s' if count > 1 else ''}: {self.warnings[0]}" if count > 0 else ""
        return (f"<hilda.Result {self.model}, {self.integrator}: {len(self)} rows up to {self.t_end:g} s, "
                f"status {self.status}{found}>")


class Events(Motions):
    """The events that were found, in the order of time. The arrays are those of a Result, with the event as first index.

    Attributes:
        names: name of each event.
        rises: whether its function rises; shape (n,).
    """

    names: list[str]
    rises: NDArray[bool_]

    def __init__(self, arrays: dict[str, Any], names: list[str]) -> None:
        self.names = [names[int(k)] for k in arrays.pop("event")]
        self.rises = arrays.pop("direction") > 0
        self.reaction_F = self.reaction_T = None
        for name, array in arrays.items():
            setattr(self, name, array)

    def __len__(self) -> int:
        return len(self.t)

    def at(self, name: str) -> NDArray[float64]:
        """The times of an event [s]."""
        times: NDArray[float64] = self.t[np.array([n == name for n in self.names], dtype=bool)]
        return times


class BodyResult(Motions):
    """The rows of one body: views of the arrays of a Result, without the index of the body."""

    def __init__(self, result: Motions, number: int, name: str) -> None:
        self.name = name
        for name in Motions.__annotations__:
            array = getattr(result, name)
            setattr(self, name, array if array is None or name == "t" else array[:, number])
