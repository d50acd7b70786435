# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings of runs, as warnings of Python."""

from __future__ import annotations

import contextlib
import contextvars
import os
import sys
import warnings
from typing import Iterable, Iterator

from .errors import SimulationWarning

_folder = os.path.dirname(__file__)
_collector: contextvars.ContextVar[list[str] | None] = contextvars.ContextVar("collector", default=None)


def warn(text: str) -> None:
    """A SimulationWarning at the line outside of the package from which it was called"""
    collector = _collector.get()
    if collector is not None:
        collector.append(text)
        return
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == _folder:
        frame, level = frame.f_back, level + 1
    warnings.warn(text, SimulationWarning, stacklevel=level)


@contextlib.contextmanager
def collected() -> Iterator[list[str]]:
    """Collects the warnings of runs in this thread, instead of passing them to Python."""
    texts: list[str] = []
    token = _collector.set(texts)
    try:
        yield texts
    finally:
        _collector.reset(token)


class RunWarnings:
    """Passes on the warnings of several runs: each text once, with the name of the first run that has it."""

    def __init__(self) -> None:
        self._known: set[str] = set()

    def add(self, run: str, texts: Iterable[str]) -> None:
        for text in texts:
            if text not in self._known:
                self._known.add(text)
                warn(f"{run}: {text}")
