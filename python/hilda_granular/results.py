# SPDX-License-Identifier: GPL-3.0-or-later
"""What a world computes from its state."""

from __future__ import annotations

from typing import NamedTuple

from numpy import bool_, float64, int32, uint32
from numpy.typing import NDArray


class Contacts(NamedTuple):
    """The contacts at an instant: those of two particles, i < j, then those with boundaries, ordered by i, then j.

    Vectors are in the global frame.
    """

    i: NDArray[uint32]
    "Ids of the particles; shape (n,)"
    j: NDArray[uint32]
    "Ids of the other particles, or numbers of the boundaries; shape (n,)"
    boundary: NDArray[bool_]
    "Whether j is a boundary; shape (n,)"
    C: NDArray[float64]
    "Points of application of F [m]; shape (n, 3)"
    n: NDArray[float64]
    "Unit normals, into i; shape (n, 3)"
    delta: NDArray[float64]
    "Overlaps [m]; shape (n,)"
    F: NDArray[float64]
    "Forces on i [N]; shape (n, 3)"
    T: NDArray[float64]
    "Rolling and spin torques on i [N m]; shape (n, 3)"
    u: NDArray[float64]
    "Tangential displacements of i relative to j [m], with mindlin-incremental elastic forces [N]; shape (n, 3)"
    replica: NDArray[int32]
    "Replicas of the particles; shape (n,)"


class Totals(NamedTuple):
    """Sums over the particles and the contacts at an instant. They do not depend on the number of threads."""

    kinetic_energy: float
    "Translational and rotational [J]"
    rotational_energy: float
    "The rotational part [J]"
    potential_energy: float
    "In gravity, along the axes that are not periodic, 0 at the origin [J]"
    momentum: NDArray[float64]
    "Linear momentum, global frame [kg m/s]; shape (3,)"
    contacts: int
    "Number of contacts"
    stress: NDArray[float64]
    "Love-Weber stress over the volume of the domain, positive in compression [Pa]; shape (3, 3)"
    F: NDArray[float64]
    "Forces of the particles on the boundaries, global frame [N]; shape (boundaries, 3)"
    T: NDArray[float64]
    "Torques about r of each boundary, global frame [N m]; shape (boundaries, 3)"


class Removed(NamedTuple):
    """Particles that were removed, ordered by time, then by id. Vectors are in the global frame."""

    t: NDArray[float64]
    "Times of the removal [s]; shape (n,)"
    id: NDArray[uint32]
    "Ids; shape (n,)"
    r: NDArray[float64]
    "Centres [m]; shape (n, 3)"
    v: NDArray[float64]
    "Velocities [m/s]; shape (n, 3)"
    omega: NDArray[float64]
    "Angular velocities [rad/s]; shape (n, 3)"
    radius: NDArray[float64]
    "Radii [m]; shape (n,)"
    mass: NDArray[float64]
    "Masses [kg], 0 for fixed particles; shape (n,)"
    side: NDArray[int32]
    "Sides of the domain, 0 to 5 for -x, +x, -y, +y, -z, +z; -1: by World.remove() or a stage; shape (n,)"
