# SPDX-License-Identifier: GPL-3.0-or-later
"""Exceptions. Their texts are those of the program `hilda-granular`."""

from __future__ import annotations

from typing import Any


class Error(Exception):
    """Base class of the errors of HILDA."""


class InvalidInput(Error, ValueError):
    """A value, a case or a file is invalid. The text says where, what is wrong, and the value."""


class UsageError(Error, ValueError):
    """A call that is not possible: a world in use by another thread, or after a failure."""


class FileError(Error, OSError):
    """A file cannot be read. The text begins with its path."""


class NotAvailable(Error, RuntimeError):
    """A device or an optional component is not available."""


class NumericalFailure(Error, ArithmeticError):
    """A computation failed. The world computes no further step.

    Attributes:
        status: short name of the failure, such as "particle_lost".
    """

    def __init__(self, status: str, message: str) -> None:
        super().__init__(message)
        self.status = status

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.status, str(self))
