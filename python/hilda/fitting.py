# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of a model fitted to measured values."""

from __future__ import annotations

import json
import math
import os
from typing import Any, Iterable, Mapping, Sequence

import numpy as np
from numpy import float64
from numpy.typing import ArrayLike, NDArray

from . import _hilda
from .errors import NumericalFailure, UsageError
from .model import Model, Source, _json
from .settings import settings_as_text
from .tables import Table, aligned, new_axes
from .warn import warn

Start = float | None | Sequence[float | None]


class Fit(Table):
    """Fitted numbers of a model with their uncertainty.

    Attributes:
        model: the fitted Model.
        parameters: the JSON pointers.
        value: the fitted numbers; shape (parameters,).
        error: their standard errors; NaN where the data do not determine a number.
        interval: confidence intervals of 95 %; shape (parameters, 2).
        bias: estimated errors by the time steps; NaN: unknown.
        at_bound: whether the minimum is at a bound, where the standard error has no meaning.
        covariance: of the values; shape (parameters, parameters).
        chi_squared: sum of ((fitted - measured)/sigma)^2.
        degrees_of_freedom: number of measured values minus number of parameters.
        sigma: estimated standard deviation of the data, if none was given; otherwise
            sqrt(chi_squared/degrees_of_freedom).
        singular_values: of the derivatives of the columns by relative changes of the parameters, descending. Their ratio
            is the condition.
        directions: columns with the relative changes that belong to the singular values.
        t: instants of the data [s]; shape (n,).
        columns, units: names and units of the columns.
        measured, fitted: values of the data and of the fitted model; shape (n, columns).
        iterations, runs: their numbers.
        converged: False only for the `fit` of a NumericalFailure.
        reason: why the iteration has ended.
        warnings: warnings about the data, the parameters and the runs.
    """

    model: Model
    value: NDArray[float64]
    error: NDArray[float64]
    interval: NDArray[float64]
    bias: NDArray[float64]
    at_bound: list[bool]
    covariance: NDArray[float64]
    chi_squared: float
    degrees_of_freedom: int
    sigma: float
    singular_values: NDArray[float64]
    directions: NDArray[float64]
    fitted: NDArray[float64]
    units: list[str]
    iterations: int
    runs: int
    converged: bool
    reason: str
    warnings: list[str]

    def __init__(self, outcome: dict[str, Any], parameters: list[str], t: NDArray[float64], columns: list[str],
                 measured: NDArray[float64], folder: str) -> None:
        self.model = Model(json.loads(outcome.pop("text")), folder=folder)
        self._name = outcome.pop("name")
        self.parameters = parameters
        self.t, self.columns, self.measured = t, columns, measured
        self.__dict__.update(outcome)

    def __getitem__(self, pointer: str) -> float:
        """The fitted number of a parameter."""
        if pointer not in self.parameters:
            raise UsageError(f"Fit: the parameter must be one of {', '.join(self.parameters)}, got '{pointer}'")
        return float(self.value[self.parameters.index(pointer)])

    def rows(self) -> list[dict[str, Any]]:
        """The table as a list of rows: parameter, value, error, low_95, high_95 and bias."""
        return [{"parameter": pointer, "value": float(self.value[k]), "error": float(self.error[k]),
                 "low_95": float(self.interval[k, 0]), "high_95": float(self.interval[k, 1]), "bias": float(self.bias[k])}
                for k, pointer in enumerate(self.parameters)]

    def plot(self, column: str | None = None, axes: Any = None) -> Any:
        """Draws the data and the fitted model of a column over time.

        Args:
            column: its name; default: the first one.
            axes: matplotlib axes; default: new ones.

        Returns the axes.
        """
        column = self.columns[0] if column is None else column
        if column not in self.columns:
            raise UsageError(f"Fit.plot: the column must be one of {', '.join(self.columns)}, got '{column}'")
        axes = new_axes() if axes is None else axes
        k = self.columns.index(column)
        axes.plot(self.t, self.fitted[:, k], "-", label="fitted model")
        axes.plot(self.t, self.measured[:, k], "o", mfc="none", ms=4, label="data")
        axes.set_xlabel("t [s]")
        axes.set_ylabel(f"{column} [{self.units[k]}]" if self.units[k] not in ("", "1") else column)
        axes.set_title(self._name)
        axes.legend()
        axes.grid(True, alpha=0.3)
        return axes

    def __repr__(self) -> str:
        cells = [["parameter", "value", "error", "bias"]]
        for row in self.rows():
            cells.append([row["parameter"], f"{row['value']:.10g}", f"{row['error']:.2e}", f"{row['bias']:.1e}"])
        title = f"{self._name}: {self.degrees_of_freedom} degrees of freedom, sigma {self.sigma:.3g}"
        return "\n".join([title, *aligned(cells), *self.warnings])


def fit(source: Source, data: str | os.PathLike[str] | Mapping[str, ArrayLike], parameters: Mapping[str, Start],
        integrator: str = "rA-dop853", *, sigma: float | Mapping[str, float] | None = None,
        columns: Sequence[str] | None = None, set: Mapping[str, Any] | None = None, folder: str | os.PathLike[str] = "",
        fix_initial: bool = False, allow_paths: bool = False, jobs: int = 1, max_fit_iterations: int = 100, step: float | None = None,
        **settings: Any) -> Fit:
    """Fits numbers of a model to measured values by least squares.

    Args:
        source: name of a built-in model, path of a model file, or a dict with its content.
        data: path of a CSV file, or a dict of arrays of the shape (n,): "t" [s], ascending, and columns of the outputs of
            a run, such as "bar_2.rx" or the name of an output. NaN: not measured.
        parameters: what is fitted, by JSON pointer: the start, None for that of the model, or (start, low, high) or
            (start, low, high, scale) with open bounds and a typical change.
        integrator: its name.
        sigma: standard deviation of the data, or of each column; default: unknown, and the same for all columns.
        columns: names of the columns; default: all of the data.
        set, folder, fix_initial, allow_paths: as for Model().
        jobs: number of concurrent runs.
        max_fit_iterations: largest number of iterations of the fit.
        step: step [s] of an integrator with fixed steps.
        **settings: the settings of Model.run(): rtol, atol, max_step, tolerance, max_iterations, linear_solver,
            rho_infinity, reparametrise, and those that integrators of plug-ins declare.

    The minimum is that of Levenberg and Marquardt's method in a trust region. Ctrl-C ends the fit. The warnings of a fit
    that reaches the minimum are SimulationWarnings as well.

    Raises:
        InvalidInput, UsageError: before the first run.
        NumericalFailure: the run with the starts fails, or the minimum is not reached; then with the Fit as attribute
            `fit`.
    """
    if isinstance(source, Model):
        raise UsageError("fit: needs the name, the path or the content of a model, whose entries it changes; got a Model")
    chosen = settings_as_text("fit", (), settings)
    if jobs < 1 or max_fit_iterations < 1:
        raise UsageError(f"fit: jobs and max_fit_iterations must be positive, got {jobs} and {max_fit_iterations}")
    t, names, values, origin = _read(data, columns)
    text, name = "", ""
    directory = os.fspath(folder)
    if isinstance(source, dict):
        text = json.dumps(_json(source), indent=1)
    else:
        name = os.fspath(source)
        if not directory and _hilda._is_path(name):
            directory = os.path.dirname(name)
    changes = [f"{pointer}={json.dumps(_json(value))}" for pointer, value in (set or {}).items()]
    outcome = _hilda._fit(name, text, directory, changes, [_parameter(*item) for item in parameters.items()], origin, t, names,
                          values, _sigma(sigma, names), integrator, step, chosen, fix_initial, allow_paths,
                          max_fit_iterations, jobs)
    result = Fit(outcome, list(parameters), t, names, values, directory)
    if not result.converged:
        reason = next(text for text in result.warnings if text.startswith("the minimum was not reached"))
        failure = NumericalFailure("not_converged", "fit: " + reason)
        failure.fit = result
        raise failure
    for text in result.warnings:
        warn(text)
    return result


def _read(data: str | os.PathLike[str] | Mapping[str, ArrayLike],
          columns: Sequence[str] | None) -> tuple[NDArray[float64], list[str], NDArray[float64], str]:
    """Instants, names of columns, values, and the name of the data in messages"""
    if not isinstance(data, Mapping):
        path = os.fspath(data)
        return (*_hilda._fit_data(path, list(columns or [])), path)
    names = [name for name in data if name != "t"] if columns is None else list(columns)
    arrays: list[NDArray[float64]] = []
    for name in ["t", *names]:
        if name not in data:
            raise UsageError(f"fit: the data have no column '{name}', only {', '.join(data)}")
        try:
            array = np.asarray(data[name], dtype=float)
        except (TypeError, ValueError):
            raise UsageError(f"fit: the column '{name}' must be an array of numbers, got {data[name]!r}") from None
        if array.ndim != 1 or (arrays and array.shape != arrays[0].shape):
            shape = arrays[0].shape if arrays else "(n,)"
            raise UsageError(f"fit: the column '{name}' must have the shape {shape}, got {array.shape}")
        arrays.append(array)
    values = np.stack(arrays[1:], axis=1) if names else np.zeros((len(arrays[0]), 0))
    return arrays[0], names, values, "data"


def _parameter(pointer: str, start: Start) -> tuple[str, float | None, float, float, float]:
    """Pointer, start, low, high, scale"""
    try:
        parts = [None if part is None else float(part) for part in (list(start) if isinstance(start, Iterable) else [start])]
        if len(parts) not in (1, 3, 4):
            raise ValueError
    except (TypeError, ValueError):
        raise UsageError(f"fit: {pointer} must have start, (start, low, high) or (start, low, high, scale), "
                         f"got {start!r}") from None
    low, high = (parts[1], parts[2]) if len(parts) > 1 else (None, None)
    scale = parts[3] if len(parts) > 3 else None
    return (pointer, parts[0], -math.inf if low is None else low, math.inf if high is None else high,
            0.0 if scale is None else scale)


def _sigma(sigma: float | Mapping[str, float] | None, columns: list[str]) -> list[float]:
    if sigma is None:
        return []
    if not isinstance(sigma, Mapping):
        return [float(sigma)] * len(columns)
    for name in [*columns, *sigma]:
        if name not in sigma or name not in columns:
            raise UsageError(f"fit: sigma and the data must have the same columns; only one of them has '{name}'")
    return [float(sigma[name]) for name in columns]
