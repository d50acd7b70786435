# SPDX-License-Identifier: GPL-3.0-or-later
"""Co-simulations of mechanisms and grains."""

from __future__ import annotations

import json
import os
import threading
from typing import Any

import numpy as np

from . import _hilda
from .errors import NumericalFailure, UsageError
from .model import _json
from .stored import StoredResult, _read_json, load
from .warn import warn

_one_at_a_time = threading.Lock()  # a co-simulation has the signals and the number of threads of the process


def cosim(file: str | os.PathLike[str], output: str | os.PathLike[str], *, set: dict[str, Any] | None = None,
          end: float | None = None, interval: float | None = None, contacts: bool = False, reactions: bool = False,
          checkpoint: float = 0.0, threads: int = 1, fix_initial: bool = False, force: bool = False,
          resume: bool = False, allow_paths: bool = False) -> StoredResult:
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
        allow_paths: accept files that are not below the folder of the file that names them.

    Returns the result that was written. The warnings of the mechanism are SimulationWarnings as well. Other threads of Python
    run meanwhile, but no other co-simulation. Ctrl-C writes a checkpoint, with which `resume` continues, and raises
    KeyboardInterrupt.

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
                             fix_initial, force, resume, allow_paths)
    finally:
        _one_at_a_time.release()
    if code > 128:
        raise KeyboardInterrupt
    if code != 0:
        summary = _read_json(os.path.join(folder, "summary.json"))
        raise NumericalFailure(summary.get("status", "failed"), f"{folder}: {summary.get('message', 'the run has failed')}")
    result = load(folder)
    for text in result.summary["model"]["warnings"]:
        warn(text)
    return result
