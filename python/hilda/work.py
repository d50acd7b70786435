# SPDX-License-Identifier: GPL-3.0-or-later
"""Error and computing time of integrators on a model."""

from __future__ import annotations

from typing import Any, Iterable, Sequence

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from .errors import UsageError
from .integrator import Integrator
from .model import Model, Source, integrators as registered
from .orders import QUANTITIES, _errors, _reference
from .tables import Table, aligned, new_axes
from .warn import RunWarnings, collected


class WorkPrecision(Table):
    """Errors over computing time. A run of an integrator with adaptive steps has a tolerance, other runs have a step.

    Attributes:
        model: name of the model.
        integrators: their names.
        resolution: steps [s] or relative tolerances of each integrator, descending.
        is_adaptive: whether the integrators have adaptive steps.
        error: root mean squares over the instants, by quantity ("r", "A", "v", "omega"): for each integrator an array in
            the order of its resolutions. NaN where a run failed.
        seconds: CPU times of the steps [s], the least of the repetitions; in the same form.
        floor: estimated error of the reference solution, by quantity.
        failures: messages of runs that failed.
    """

    def __init__(self, model: str, integrators: list[str], resolution: list[list[float]], is_adaptive: list[bool],
                 floor: dict[str, float]) -> None:
        self.model = model
        self.integrators = integrators
        self.resolution = resolution
        self.is_adaptive = is_adaptive
        self.error: dict[str, list[NDArray[float64]]] = {
            name: [np.full(len(values), np.nan) for values in resolution] for name in QUANTITIES}
        self.seconds: list[NDArray[float64]] = [np.full(len(values), np.nan) for values in resolution]
        self.floor = floor
        self.failures: list[str] = []

    def needed(self, error: float, quantity: str = "r") -> dict[str, float]:
        """The computing time [s] of each integrator for this error, interpolated between two of its runs in the logarithms.

        NaN where no two neighbouring runs enclose the error.
        """
        times = {}
        for name, errors, seconds in zip(self.integrators, self._of(quantity), self.seconds):
            times[name] = float("nan")
            for k in range(len(errors) - 1):
                if errors[k + 1] < error <= errors[k] and errors[k + 1] > 0:
                    part = np.log(errors[k] / error) / np.log(errors[k] / errors[k + 1])
                    times[name] = float(seconds[k] * (seconds[k + 1] / seconds[k]) ** part)
        return times

    def rows(self) -> list[dict[str, Any]]:
        """The table as a list of rows: integrator, step or rtol, seconds, and the error of each quantity."""
        table = []
        for i, integrator in enumerate(self.integrators):
            for k, value in enumerate(self.resolution[i]):
                row: dict[str, Any] = {"integrator": integrator, "step": float("nan") if self.is_adaptive[i] else value,
                                       "rtol": value if self.is_adaptive[i] else float("nan"),
                                       "seconds": float(self.seconds[i][k])}
                row.update((f"error_{name}", float(self.error[name][i][k])) for name in self.error)
                table.append(row)
        return table

    def plot(self, quantity: str = "r", axes: Any = None) -> Any:
        """Draws the errors of a quantity over the computing time. Returns the matplotlib axes."""
        errors = self._of(quantity)
        axes = new_axes() if axes is None else axes
        for integrator, values, seconds in zip(self.integrators, errors, self.seconds):
            axes.loglog(seconds, values, "o-", label=integrator)
        axes.set_xlabel("CPU time [s]")
        axes.set_ylabel(f"rms error of {quantity} [{QUANTITIES[quantity]}]")
        axes.set_title(self.model)
        axes.legend()
        axes.grid(True, which="both", alpha=0.3)
        return axes

    def _of(self, quantity: str) -> list[NDArray[float64]]:
        if quantity not in self.error:
            raise UsageError(f"WorkPrecision: the quantity must be one of {', '.join(self.error)}, got '{quantity}'")
        return self.error[quantity]

    def __repr__(self) -> str:
        cells = [["integrator", "step or rtol", "CPU time [s]", "error of r [m]"]]
        for row in self.rows():
            value = row["step"] if np.isnan(row["rtol"]) else row["rtol"]
            cells.append([row["integrator"], f"{value:g}", f"{row['seconds']:.2e}", f"{row['error_r']:.2e}"])
        return "\n".join([self.model, *aligned(cells), *self.failures])


def work_precision(model: Model | Source, integrators: Iterable[str | type[Integrator]], steps: Sequence[float] = (),
                   rtols: Sequence[float] = (), *, end: float | None = None, instants: int = 30, repeats: int = 3,
                   **options: Any) -> WorkPrecision:
    """Measures error and computing time of integrators.

    Args:
        model: a Model, or what Model() takes.
        integrators: names, and classes derived from Integrator.
        steps: steps [s] of the integrators with a fixed step. The end of the runs divided by `instants` must be a multiple
            of each.
        rtols: relative tolerances of the integrators that can choose their steps. Without rtols they take the steps.
        end: end of the runs [s]; default: that of the model.
        instants: number of equal intervals, at whose ends the errors are compared.
        repeats: repetitions of each run; the least CPU time counts.
        **options: options of Model.run(), such as tolerance.

    The runs are computed one after the other. The reference solution is rA-dop853 with rtol 1e-13; a second one with
    1e-11 estimates its error. The warnings of the runs that do not fail are SimulationWarnings,
    each text once, with the run. The figures of a study are those of `hilda study work-precision`, which has more models.
    """
    model = model if isinstance(model, Model) else Model(model)
    chosen = list(integrators)
    names = [i if isinstance(i, str) else i.__name__ for i in chosen]
    if not chosen:
        raise UsageError("work_precision: there is no integrator")
    if instants < 1 or repeats < 1:
        raise UsageError(f"work_precision: instants and repeats must be positive, got {instants} and {repeats}")
    known = registered()
    is_adaptive = [isinstance(i, str) and i in known and known[i]["adaptive"] and len(rtols) > 0 for i in chosen]
    duration = model.end if end is None else float(end)
    interval = duration / instants
    values = {False: _descending("steps", steps), True: _descending("rtols", rtols)}
    for name, adaptive in zip(names, is_adaptive):
        if not values[adaptive]:
            raise UsageError(f"work_precision: {name} needs steps")
    for h in values[False]:
        if abs(interval / h - round(interval / h)) > 1e-9 * interval / h or interval < h * (1 - 1e-9):
            raise UsageError(f"work_precision: the interval {interval:g} s between the instants must be a multiple of each step, "
                             f"got {h:g} s")

    found = RunWarnings()
    exact, coarser = _reference(model, duration, interval, found)
    study = WorkPrecision(model.name, names, [list(values[a]) for a in is_adaptive], is_adaptive, _errors(coarser, exact))
    for i, integrator in enumerate(chosen):
        for k, value in enumerate(study.resolution[i]):
            resolution: dict[str, Any] = {"rtol" if is_adaptive[i] else "step": value}
            name = f"{names[i]} with {next(iter(resolution))} {value:g}"
            try:
                with collected() as texts:
                    results = [model.run(integrator, end=duration, interval=interval, **resolution, **options)
                               for _ in range(repeats)]
            except ArithmeticError as failure:  # hilda.NumericalFailure
                study.failures.append(f"{name}: {failure}")
                continue
            found.add(name, texts)
            study.seconds[i][k] = min(result.seconds for result in results)
            for quantity, error in _errors(results[0], exact).items():
                study.error[quantity][i][k] = error
    return study


def _descending(what: str, values: Sequence[float]) -> list[float]:
    descending = sorted(map(float, values), reverse=True)
    if descending and not (np.isfinite(descending).all() and descending[-1] > 0):
        raise UsageError(f"work_precision: {what} must be positive and finite, got {list(values)}")
    return descending
