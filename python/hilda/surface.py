# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces of contacts written in Python."""

from __future__ import annotations

from numpy import float64
from numpy.typing import ArrayLike, NDArray


class Surface:
    """Base class of a surface G(a) = 0 in its own frame, for the keys surface_i and surface_j of Model.contact().

    A derived class implements value() and gradient(), which are called in the neighbourhood of the surface. G grows by
    about 1 per metre there. It may implement

    - hessian(a): second derivatives of G, shape (3, 3); otherwise differences of the gradient with an error of 1e-10,
    - support(u): for a convex body, the point of the surface that is farthest along the unit vector u; shape (3,).

    Attributes:
        size: characteristic length [m], by which tolerances are scaled; 0 for an unbounded surface.
        concave: whether the material is outside, where G > 0: the other body touches it from inside.

    Each call takes about 2 us beyond the work of the function itself. A contact makes tens of calls in each step.
    """

    size: float = 0.0
    concave: bool = False

    def value(self, a: NDArray[float64]) -> float:
        """G [m] at the point a [m], shape (3,)."""
        raise NotImplementedError(f"{type(self).__name__} has no value()")

    def gradient(self, a: NDArray[float64]) -> ArrayLike:
        """Gradient of G at the point a; shape (3,)."""
        raise NotImplementedError(f"{type(self).__name__} has no gradient()")
