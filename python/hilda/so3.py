# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotations. The functions take arrays of vectors, shape (..., 3), and matrices, shape (..., 3, 3)."""

from __future__ import annotations

import numpy as np
from numpy import float64
from numpy.typing import ArrayLike, NDArray


def tilde(a: ArrayLike) -> NDArray[float64]:
    """The matrix with tilde(a) b = a x b."""
    a = np.asarray(a, dtype=float)
    out = np.zeros(a.shape + (3,))
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -z, y, -x
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = z, -y, x
    return out


def exp(theta: ArrayLike) -> NDArray[float64]:
    """exp(tilde(theta)): the rotation by |theta| about theta (Rodrigues)."""
    theta = np.asarray(theta, dtype=float)
    angle = np.linalg.norm(theta, axis=-1)[..., None, None]
    half = np.sinc(angle / (2 * np.pi))
    skew = tilde(theta)
    out: NDArray[float64] = np.eye(3) + np.sinc(angle / np.pi) * skew + 0.5 * half**2 * (skew @ skew)
    return out
