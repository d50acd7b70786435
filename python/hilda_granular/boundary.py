# SPDX-License-Identifier: GPL-3.0-or-later
"""Boundaries of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy import float64
from numpy.typing import ArrayLike, NDArray

from .arrays import numbers

if TYPE_CHECKING:
    from . import _granular


class Boundary:
    """A boundary of a World, from World.boundary(). Vectors have the shape (3,) and the global frame.

    A vector is a new array; it is set as a whole: `tool.v = [0, 0, -0.1]`. What the case prescribes by a formula
    cannot be set, nor velocities and loads of a part of another boundary.

    Attributes:
        name: name in the case.
        number: its number, as in the arrays of World.contacts() and World.totals().
    """

    def __init__(self, core: _granular._World, number: int) -> None:
        self._core = core
        self.number = number
        self.name = core.boundaries[number]

    @property
    def mass(self) -> float:
        """Mass [kg] of a rigid body that moves under its loads; 0: the motion is prescribed."""
        return self._core.mass_of(self.number)

    @property
    def r(self) -> NDArray[float64]:
        """Reference point [m]; of a rigid body its centre of mass."""
        return self._core.boundary(self.number, "r")

    @property
    def axis(self) -> NDArray[float64]:
        """Axis or normal, a unit vector."""
        return self._core.boundary(self.number, "axis")

    @property
    def v(self) -> NDArray[float64]:
        """Velocity of the reference point [m/s]. Can be set; it stays constant unless the boundary has a mass."""
        return self._core.boundary(self.number, "v")

    @v.setter
    def v(self, value: ArrayLike) -> None:
        self._set("v", value)

    @property
    def omega(self) -> NDArray[float64]:
        """Angular velocity [rad/s]. Can be set; it stays constant unless loads rotate the boundary."""
        return self._core.boundary(self.number, "omega")

    @omega.setter
    def omega(self, value: ArrayLike) -> None:
        self._set("omega", value)

    @property
    def F(self) -> NDArray[float64]:
        """Applied force [N] on a boundary with a mass, beside contacts and gravity. Can be set; it stays constant."""
        return self._core.boundary(self.number, "F")

    @F.setter
    def F(self, value: ArrayLike) -> None:
        self._set("F", value)

    @property
    def T(self) -> NDArray[float64]:
        """Applied torque about r [N m] on a boundary with a mass. Can be set; it stays constant."""
        return self._core.boundary(self.number, "T")

    @T.setter
    def T(self, value: ArrayLike) -> None:
        self._set("T", value)

    def wrench(self) -> tuple[NDArray[float64], NDArray[float64]]:
        """Force [N] and torque about r [N m] of the particles at t, also on the parts of the boundary.

        All contacts are summed: for several boundaries, World.totals() takes the time of one.
        """
        return self._core.wrench(self.number)

    def load(self) -> tuple[NDArray[float64], NDArray[float64]]:
        """Force [N] and torque [N m] of the particles in the last step, of a boundary with a mass.

        They are those of the beginning of the step, with velocity-verlet of its end, and take no computation.
        """
        return self._core.load(self.number)

    def _set(self, key: str, value: ArrayLike) -> None:
        self._core.set_boundary(self.number, key, numbers(f"Boundary.{key} of '{self.name}'", value, None, 3))

    def __repr__(self) -> str:
        return f"<hilda_granular.Boundary {self.number} '{self.name}'>"
