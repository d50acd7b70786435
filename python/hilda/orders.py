# SPDX-License-Identifier: GPL-3.0-or-later
"""Order of convergence of integrators on a model."""

from __future__ import annotations

from typing import Any, Iterable, Sequence

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from .errors import UsageError
from .integrator import Integrator
from .model import Model, Source
from .result import Result
from .tables import Table, new_axes
from .warn import RunWarnings, collected

QUANTITIES = {"r": "m", "A": "1", "v": "m/s", "omega": "rad/s"}


class Convergence(Table):
    """Errors and orders.

    Attributes:
        model: name of the model.
        integrators: their names.
        steps: the steps [s], descending.
        error: root mean squares over the instants, by quantity ("r", "A", "v", "omega"); shape (integrators, steps).
            NaN where a run failed.
        order: orders between neighbouring steps, by quantity; shape (integrators, steps - 1).
        floor: estimated error of the reference solution, by quantity. Orders of errors below ten times the floor are
            NaN.
        failures: messages of runs that failed.
    """

    def __init__(self, model: str, integrators: list[str], steps: list[float], error: dict[str, NDArray[float64]],
                 floor: dict[str, float], failures: list[str]) -> None:
        self.model = model
        self.integrators = integrators
        self.steps = steps
        self.error = error
        self.floor = floor
        self.failures = failures
        self.order: dict[str, NDArray[float64]] = {}
        ratio = np.log(np.array(steps[:-1]) / steps[1:])
        for name, values in error.items():
            known = np.where(values > 10 * floor[name], values, np.nan)
            self.order[name] = np.log(known[:, :-1] / known[:, 1:]) / ratio

    def rows(self) -> list[dict[str, Any]]:
        """The table as a list of rows: integrator, step, error and order of each quantity."""
        table = []
        for i, integrator in enumerate(self.integrators):
            for k, step in enumerate(self.steps):
                row: dict[str, Any] = {"integrator": integrator, "step": step}
                for name in self.error:
                    row[f"error_{name}"] = float(self.error[name][i, k])
                    row[f"order_{name}"] = float(self.order[name][i, k - 1]) if k > 0 else float("nan")
                table.append(row)
        return table

    def plot(self, quantity: str = "r", axes: Any = None) -> Any:
        """Draws the errors of a quantity over the step. Returns the matplotlib axes."""
        if quantity not in self.error:
            raise UsageError(f"Convergence.plot: the quantity must be one of {', '.join(self.error)}, got '{quantity}'")
        axes = new_axes() if axes is None else axes
        for integrator, values in zip(self.integrators, self.error[quantity]):
            axes.loglog(self.steps, values, "o-", label=integrator)
        axes.set_xlabel("h [s]")
        axes.set_ylabel(f"rms error of {quantity} [{QUANTITIES[quantity]}]")
        axes.set_title(self.model)
        axes.legend()
        axes.grid(True, which="both", alpha=0.3)
        return axes

    def __repr__(self) -> str:
        width = max(map(len, self.integrators), default=0)
        lines = [f"{self.model}: rms errors of r [m], and orders"]
        for i, name in enumerate(self.integrators):
            values = [f"{value:.3e}" for value in self.error["r"][i]]
            orders = [f"({value:.2f})" if np.isfinite(value) else "" for value in self.order["r"][i]]
            cells = [values[0]] + [f"{value} {order}" for value, order in zip(values[1:], orders)]
            lines.append("  ".join([name.rjust(width), *cells]))
        return "\n".join(lines + self.failures)


def convergence(model: Model | Source, integrators: Iterable[str | type[Integrator]], steps: Sequence[float], *,
                end: float | None = None, instants: int = 30, **options: Any) -> Convergence:
    """Measures the order of integrators with a fixed step.

    Args:
        model: a Model, or what Model() takes.
        integrators: names, and classes derived from Integrator.
        steps: steps [s]; the largest one must be a multiple of each.
        end: end of the runs [s]; default: that of the model.
        instants: the errors are root mean squares over at most this many instants.
        **options: options of Model.run(), such as tolerance.

    The reference solution is rA-dop853 with rtol 1e-13; a second one with 1e-11 estimates its error. The warnings of the
    runs that do not fail are SimulationWarnings, each text once, with the run.
    """
    model = model if isinstance(model, Model) else Model(model)
    chosen = list(integrators)
    names = [i if isinstance(i, str) else i.__name__ for i in chosen]
    descending = sorted(map(float, steps), reverse=True)
    if len(descending) < 2 or not all(np.isfinite(descending)) or descending[-1] <= 0:
        raise UsageError(f"convergence: needs two steps or more, positive and finite, got {list(steps)}")
    if len(set(descending)) < len(descending):
        raise UsageError(f"convergence: a step is given twice: {list(steps)}")
    largest = descending[0]
    for h in descending:
        if abs(largest / h - round(largest / h)) > 1e-9 * largest / h:
            raise UsageError(f"convergence: the largest step {largest} s must be a multiple of each step, got {h} s")
    if instants < 1:
        raise UsageError(f"convergence: instants must be positive, got {instants}")
    duration = model.end if end is None else float(end)
    count = int(duration / largest * (1 + 1e-9))  # of the largest steps
    if count < 1:
        raise UsageError(f"convergence: the end {duration} s must be at least the largest step {largest} s")
    interval = largest * -(-count // instants)
    duration = interval * max(1, int(count * largest / interval * (1 + 1e-9)))

    found = RunWarnings()
    exact, coarser = _reference(model, duration, interval, found)
    floor = _errors(coarser, exact)
    error = {name: np.full((len(names), len(descending)), np.nan) for name in QUANTITIES}
    failures = []
    for i, integrator in enumerate(chosen):
        for k, h in enumerate(descending):
            name = f"{names[i]} at h = {h:g} s"
            try:
                with collected() as texts:
                    result = model.run(integrator, step=h, end=duration, interval=interval, **options)
            except ArithmeticError as failure:  # hilda.NumericalFailure
                failures.append(f"{name}: {failure}")
                continue
            found.add(name, texts)
            for quantity, value in _errors(result, exact).items():
                error[quantity][i, k] = value
    return Convergence(model.name, names, descending, error, floor, failures)


def _reference(model: Model, end: float, interval: float, found: RunWarnings) -> list[Result]:
    """The reference solution, and one with larger tolerances"""
    runs = []
    for rtol in (1e-13, 1e-11):
        with collected() as texts:
            runs.append(model.run("rA-dop853", rtol=rtol, end=end, interval=interval))
        found.add(f"reference solution with rtol {rtol:g}", texts)
    return runs


def _errors(result: Result, exact: Result) -> dict[str, float]:
    """Root mean squares over the instants after the start and over the bodies"""
    pairs = {"r": (result.r, exact.r), "A": (result.A, exact.A), "v": (result.rdot, exact.rdot),
             "omega": (result.omega_bar, exact.omega_bar)}
    errors = {}
    for name, (a, b) in pairs.items():
        if a.shape != b.shape:
            raise UsageError(f"convergence: a run has {len(a)} rows, the reference solution {len(b)}")
        square = ((a[1:] - b[1:]) ** 2).reshape(*a[1:].shape[:2], -1).sum(axis=-1)
        errors[name] = float(np.sqrt(square.mean())) if square.size else 0.0
    return errors
