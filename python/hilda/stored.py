# SPDX-License-Identifier: GPL-3.0-or-later
"""Results in folders: of the program, and of co-simulations."""

from __future__ import annotations

import csv
import json
import os
import threading
from typing import Any

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from . import _hilda
from .errors import FileError, InvalidInput, NumericalFailure, UsageError
from .model import _json
from .result import BodyResult, Motions

Table = dict[str, NDArray[float64]]
_one_at_a_time = threading.Lock()  # a co-simulation has the signals and the number of threads of the process


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

    def _vectors(self, trajectory: Table, name: str, components: str = "xyz") -> NDArray[float64]:
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


def cosim(file: str | os.PathLike[str], output: str | os.PathLike[str], *, set: dict[str, Any] | None = None,
          end: float | None = None, interval: float | None = None, contacts: bool = False, reactions: bool = False,
          checkpoint: float = 0.0, threads: int = 1, fix_initial: bool = False, force: bool = False,
          resume: bool = False) -> StoredResult:
    """Simulates a mechanism and grains that act on each other, as `hilda cosim`.

    Args:
        file: path of a co-simulation file, see docs/guide/cosimulation.md.
        output: folder of the results of the mechanism; those of the grains are in its folder grains.
        set: changes of the file, from JSON pointers to values.
        end: end time [s]; default: that of the file.
        interval: time between rows of the mechanism [s]; default: that of the file.
        contacts, reactions: write the contacts, and the constraint forces of the mechanism.
        checkpoint: wall time between checkpoints [s]; 0: none.
        threads: of the grains.
        fix_initial: project inconsistent initial data onto the constraints.
        force: overwrite a folder that is not empty.
        resume: continue the run in the folder from its last checkpoint, also to a later end.

    Returns the result that was written. Other threads of Python run meanwhile, but no other co-simulation. Ctrl-C writes a checkpoint, with which
    `resume` continues, and raises KeyboardInterrupt.

    Raises:
        InvalidInput, UsageError, FileError: before the run.
        NumericalFailure: with the reason; the folder has the rows up to it.
    """
    if force and resume:
        raise UsageError("cosim: force and resume exclude each other")
    if not os.fspath(output):
        raise UsageError("cosim: output must be the path of a folder, got an empty text")
    if not 1 <= threads <= 1024:
        raise UsageError(f"cosim: threads must be from 1 to 1024, got {threads}")
    for name, value in (("end", end), ("interval", interval), ("checkpoint", checkpoint)):
        if value is not None and not (value >= 0 and np.isfinite(value)):
            raise UsageError(f"cosim: {name} must be finite and not negative, got {value}")
    changes = [f"{pointer}={json.dumps(_json(value))}" for pointer, value in (set or {}).items()]
    folder = os.fspath(output)
    if not _one_at_a_time.acquire(blocking=False):
        raise UsageError("cosim: another thread runs a co-simulation; a process has one at a time")
    try:
        code = _hilda._cosim(os.fspath(file), folder, changes, end, interval, contacts, reactions, checkpoint, threads,
                             fix_initial, force, resume)
    finally:
        _one_at_a_time.release()
    if code > 128:
        raise KeyboardInterrupt
    if code != 0:
        summary = _read_json(os.path.join(folder, "summary.json"))
        raise NumericalFailure(summary.get("status", "failed"), f"{folder}: {summary.get('message', 'the run has failed')}")
    return load(folder)


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


def _read_tables(folder: str) -> dict[str, Table]:
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


def _read_csv(path: str) -> Table:
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
