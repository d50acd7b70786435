# SPDX-License-Identifier: GPL-3.0-or-later
"""Exceptions and warnings. Their texts are those of the program `hilda`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .fitting import Fit
    from .result import Result


class Error(Exception):
    """Base class of the errors of HILDA."""


class InvalidInput(Error, ValueError):
    """A value, a model or a file is invalid. The text says where, what is wrong, and the value."""


class UsageError(Error, ValueError):
    """Options that do not fit each other or the model."""


class FileError(Error, OSError):
    """A file cannot be read or written. The text begins with its path."""


class NotAvailable(Error, RuntimeError):
    """A device or an optional component is not available."""


class SimulationWarning(UserWarning):
    """The result of a run may be wrong or incomplete: a warning of the model, of the checks before the run, or of its steps.

    warnings.simplefilter("ignore", hilda.SimulationWarning) silences them, and "error" makes them exceptions. Results have
    their texts in any case.
    """


class NumericalFailure(Error, ArithmeticError):
    """A computation failed.

    Attributes:
        status: short name of the failure, such as "newton_diverged".
        result: the Result up to the time that a run reached, or None.
        fit: the Fit with the last values of a fit that has not reached the minimum, or None.
    """

    def __init__(self, status: str, message: str) -> None:
        super().__init__(message)
        self.status = status
        self.result: Result | None = None
        self.fit: Fit | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.status, str(self)), self.__dict__
