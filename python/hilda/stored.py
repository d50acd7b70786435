# SPDX-License-Identifier: GPL-3.0-or-later
"""Results in folders."""

from __future__ import annotations

import csv
import json
import os
from typing import Any

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from .errors import FileError, InvalidInput
from .result import BodyResult, Motions

Columns = dict[str, NDArray[float64]]


class StoredResult(Motions):
    """The result of a run or a co-simulation in a folder. The arrays are those of a Result.

    Attributes:
        folder: its path.
        summary: content of summary.json; empty if the run has not ended.
        model: content of model.json; empty for a granular run.
        bodies: names of the bodies.
        energy: kinetic and potential energy [J]; shape (n,).
        tables: tables of the folder by name ("trajectory", "contacts", "forces", "outputs", "events", "run"), each a dict of
            columns; shape (rows,). NaN for empty cells.
        grains: the result of the grains of a co-simulation, or None.
    """

    energy: NDArray[float64]

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = os.fspath(folder)
        if not os.path.isdir(self.folder):
            raise FileError(f"{self.folder}: is not a directory")
        self.summary = _read_json(os.path.join(self.folder, "summary.json"))
        self.model = _read_json(os.path.join(self.folder, "model.json"))
        self.tables = _read_tables(self.folder)
        if "trajectory" not in self.tables and "run" not in self.tables:
            raise InvalidInput(f"{self.folder}: contains no trajectory.csv, run.h5 or run.csv; it is no result of a run")
        below = os.path.join(self.folder, "grains")
        self.grains = StoredResult(below) if os.path.isfile(os.path.join(below, "run.csv")) else None
        trajectory = self.tables.get("trajectory", {})
        self.bodies = [name[:-3] for name in trajectory if name.endswith(".rx")]
        of_time = "trajectory" if trajectory else "run"
        if "t" not in self.tables[of_time]:
            raise InvalidInput(f"{self.folder}: {of_time} has no column t")
        self.t = self.tables[of_time]["t"]
        self.energy = trajectory.get("energy", np.full(len(self.t), np.nan))
        self.r, self.rdot, self.rddot = (self._vectors(trajectory, name) for name in ("r", "v", "a"))
        self.omega_bar, self.omegadot_bar = (self._vectors(trajectory, name) for name in ("w", "al"))
        self.A = np.stack([self._vectors(trajectory, f"A{i}", "123") for i in "123"], axis=2)
        self.reaction_F = self.reaction_T = None

    def _vectors(self, trajectory: Columns, name: str, components: str = "xyz") -> NDArray[float64]:
        """Shape (n, bodies, 3)"""
        array = np.empty((len(self.t), len(self.bodies), 3))
        for b, body in enumerate(self.bodies):
            for k, component in enumerate(components):
                column = f"{body}.{name}{component}"
                if column not in trajectory:
                    raise InvalidInput(f"{self.folder}: trajectory has no column {column}")
                array[:, b, k] = trajectory[column]
        return array

    def __len__(self) -> int:
        return len(self.t)

    def __getitem__(self, body: str) -> BodyResult:
        """The rows of one body, by its name."""
        if body not in self.bodies:
            raise KeyError(f"no body '{body}'; the bodies are {', '.join(self.bodies)}")
        return BodyResult(self, self.bodies.index(body), body)

    def __repr__(self) -> str:
        return f"<hilda.StoredResult {self.folder}: {len(self)} rows, {', '.join(self.tables)}>"


def load(folder: str | os.PathLike[str]) -> StoredResult:
    """Reads the result of `hilda run`, `hilda cosim` or `hilda granular` from its folder, CSV or HDF5 tables."""
    return StoredResult(folder)


def _read_json(path: str) -> dict[str, Any]:
    """The content of a JSON file; empty if there is none"""
    if not os.path.isfile(path):
        return {}
    try:
        with open(path, encoding="utf-8") as file:
            content: dict[str, Any] = json.load(file)
            return content
    except ValueError as error:
        raise InvalidInput(f"{path}: is not a JSON file: {error}") from None


def _read_tables(folder: str) -> dict[str, Columns]:
    tables = {}
    for name in ("trajectory", "contacts", "forces", "outputs", "events", "run"):
        path = os.path.join(folder, name + ".csv")
        if os.path.isfile(path):
            tables[name] = _read_csv(path)
    path = os.path.join(folder, "run.h5")
    if os.path.isfile(path):
        try:
            import h5py
        except ImportError:
            raise InvalidInput(f"{path}: Python has no h5py (Debian: apt-get install python3-h5py)") from None
        try:
            with h5py.File(path) as file:
                for name in file:
                    if name not in tables and hasattr(file[name], "items"):
                        tables[name] = {key: np.asarray(values, dtype=float) for key, values in file[name].items()}
        except OSError as error:
            raise InvalidInput(f"{path}: cannot be read: {error}") from None
    return tables


def _read_csv(path: str) -> Columns:
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.reader(line for line in file if line.strip() and not line.startswith("#")))
        if not rows:
            raise ValueError("has no header")
        values = np.array([[float(cell or "nan") for cell in row] for row in rows[1:]], dtype=float)
        if values.size == 0:
            values = np.empty((0, len(rows[0])))
        if values.ndim != 2 or values.shape[1] != len(rows[0]):
            raise ValueError("has rows of different lengths")
    except ValueError as error:  # also text that is not UTF-8
        raise InvalidInput(f"{path}: {error}") from None
    return {name: values[:, k] for k, name in enumerate(rows[0])}
