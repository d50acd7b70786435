# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of a model for many values of its entries."""

from __future__ import annotations

import itertools
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Mapping, Sequence

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from .errors import UsageError
from .model import Model, Source
from .result import Result
from .tables import Table, aligned, new_axes
from .warn import RunWarnings, collected


class Sweep(Table):
    """Numbers measured over a grid of values.

    Attributes:
        model: name or path of the model; "model" for a dict.
        grid: the values of each entry, by JSON pointer.
        measured: arrays by the name of the measured number; the shape is that of the grid, in the order of `grid`. NaN
            where a run failed.
        failures: messages of runs that failed.
    """

    def __init__(self, model: str, grid: dict[str, list[Any]], measured: dict[str, NDArray[float64]],
                 failures: list[str]) -> None:
        self.model = model
        self.grid = grid
        self.measured = measured
        self.failures = failures

    def rows(self) -> list[dict[str, Any]]:
        """The table as a list of rows: the values of the entries, then the measured numbers."""
        table = []
        for index in np.ndindex(*(len(values) for values in self.grid.values())):
            row: dict[str, Any] = {pointer: values[k] for (pointer, values), k in zip(self.grid.items(), index)}
            row.update((name, float(values[index])) for name, values in self.measured.items())
            table.append(row)
        return table

    def plot(self, name: str | None = None, axes: Any = None) -> Any:
        """Draws a measured number over the first entry of the grid, with a curve for each value of the others.

        Args:
            name: the number; default: the first one.
            axes: matplotlib axes; default: new ones.

        Returns the axes.
        """
        name = next(iter(self.measured)) if name is None else name
        if name not in self.measured:
            raise UsageError(f"Sweep.plot: the name must be one of {', '.join(self.measured)}, got '{name}'")
        axes = new_axes() if axes is None else axes
        pointers, values = list(self.grid), list(self.grid.values())
        for index in np.ndindex(*(len(v) for v in values[1:])):
            label = ", ".join(f"{pointer} = {v[k]}" for pointer, v, k in zip(pointers[1:], values[1:], index))
            axes.plot(values[0], np.moveaxis(self.measured[name], 0, -1)[index], "o-", label=label)
        axes.set_xlabel(pointers[0])
        axes.set_ylabel(name)
        axes.set_title(self.model)
        if len(pointers) > 1:
            axes.legend()
        axes.grid(True, alpha=0.3)
        return axes

    def __repr__(self) -> str:
        rows = self.rows()
        cells = [list(rows[0])] + [[f"{v:.6g}" if isinstance(v, float) else str(v) for v in row.values()] for row in rows]
        return "\n".join([f"{self.model}: {len(rows)} runs", *aligned(cells), *self.failures])


def sweep(source: Source, grid: Mapping[str, Sequence[Any]], measure: Mapping[str, Callable[[Result], float]],
          integrator: str = "rA-half-1-momentum", *, jobs: int = 1, **options: Any) -> Sweep:
    """Runs a model for all combinations of values of its entries, and measures numbers of each run.

    Args:
        source: name of a built-in model, path of a model file, or a dict with its content.
        grid: values of entries, by JSON pointer: {"/bodies/0/mass": [1, 2, 4]}.
        measure: functions of a Result, by the name of the number: {"height": lambda r: r.r[-1, 0, 2]}.
        integrator: its name.
        jobs: number of threads. The functions of `measure` are called in the calling thread.
        **options: options of Model.run(), such as step, rtol and end.

    A run that fails numerically has NaN, and its message is in `failures`. The warnings of the other runs are
    SimulationWarnings, each text once, with the values of the run. Other errors are raised: an entry that does
    not exist is InvalidInput.
    """
    if isinstance(source, Model):
        raise UsageError("sweep: needs the name, the path or the content of a model, whose entries it changes; got a Model")
    lists = {pointer: list(values) for pointer, values in grid.items()}
    if not lists or not all(lists.values()):
        raise UsageError(f"sweep: each entry of the grid needs one value or more, got {dict(grid)}")
    if not measure:
        raise UsageError("sweep: measure has no function")
    if jobs < 1:
        raise UsageError(f"sweep: jobs must be positive, got {jobs}")
    shape = tuple(map(len, lists.values()))
    measured = {name: np.full(shape, np.nan) for name in measure}
    failures = []

    def run(values: tuple[Any, ...]) -> tuple[Result | ArithmeticError, list[str]]:
        with collected() as texts:  # of this thread; those of a failure are not reported
            try:
                return Model(source, set=dict(zip(lists, values))).run(integrator, **options), texts
            except ArithmeticError as failure:  # hilda.NumericalFailure
                return failure, []

    found = RunWarnings()
    combinations = list(itertools.product(*lists.values()))
    with ThreadPoolExecutor(jobs) as pool:
        for index, values, (result, texts) in zip(np.ndindex(*shape), combinations, pool.map(run, combinations)):
            place = ", ".join(f"{pointer} = {value}" for pointer, value in zip(lists, values))
            if isinstance(result, ArithmeticError):
                failures.append(f"{place}: {result}")
                continue
            found.add(place, texts)
            for name, function in measure.items():
                measured[name][index] = function(result)
    return Sweep("model" if isinstance(source, dict) else str(source), lists, measured, failures)
