# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of the arrays that a world receives."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numpy import float64, uint32
from numpy.typing import NDArray

from .errors import InvalidInput


def numbers(where: str, value: Any, rows: int | None, width: int | None = None) -> NDArray[float64]:
    """A contiguous array of finite numbers.

    Its shape is (rows,), or (rows, width); one row, or one number without a width, stands for all rows. With
    rows=None it is (width,).
    """
    try:
        given = np.asarray(value)
    except ValueError as error:  # lists of different lengths
        raise InvalidInput(f"{where}: must be an array of numbers: {error}") from None
    if given.dtype.kind not in "fiu":
        what = f"an array of {given.dtype}" if isinstance(value, np.ndarray) else type(value).__name__
        raise InvalidInput(f"{where}: must be an array of numbers, got {what}")
    row = () if width is None else (width,)
    shape = row if rows is None else (rows, *row)
    if given.shape not in (shape, row):
        raise InvalidInput(f"{where}: must have the shape {shape}" + ("" if rows is None else f" or {row}") + f", got {given.shape}")
    array = np.ascontiguousarray(np.broadcast_to(given, shape), dtype=float64)
    if not np.isfinite(array).all():
        first = tuple(int(k) for k in np.argwhere(~np.isfinite(array))[0])
        raise InvalidInput(f"{where}: must be finite, got {array[first]} at index {list(first)}")
    return array


def ids_of(where: str, value: Any) -> NDArray[uint32]:
    """Ids of particles: a contiguous array of the shape (n,). One number is one id."""
    try:
        given = np.asarray(value)
    except ValueError as error:  # lists of different lengths
        raise InvalidInput(f"{where}: ids must be an array of whole numbers: {error}") from None
    if given.size == 0:
        return np.empty(0, dtype=uint32)
    if given.dtype.kind not in "iu":
        raise InvalidInput(f"{where}: ids must be whole numbers, got {given.dtype if isinstance(value, np.ndarray) else value!r}")
    if given.ndim > 1:
        raise InvalidInput(f"{where}: ids must have the shape (n,), got {given.shape}")
    given = np.atleast_1d(given)
    wrong = given[(given < 0) | (given > np.iinfo(uint32).max)]
    if wrong.size > 0:
        raise InvalidInput(f"{where}: no particle has this id, got {wrong[0]}")
    numbers_of, counts = np.unique(given, return_counts=True)
    if (counts > 1).any():
        raise InvalidInput(f"{where}: an id is given twice, {numbers_of[counts > 1][0]}")
    return np.ascontiguousarray(given, dtype=uint32)


def whole(where: str, value: Any, low: int, high: int) -> int:
    """A whole number from low to high."""
    try:
        number = operator.index(value)
    except TypeError:
        raise InvalidInput(f"{where} must be a whole number from {low} to {high}, got {value!r}") from None
    if not low <= number <= high:
        raise InvalidInput(f"{where} must be a whole number from {low} to {high}, got {number}")
    return number
