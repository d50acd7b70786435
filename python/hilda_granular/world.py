# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds of particles."""

from __future__ import annotations

import json
import operator
import os
from typing import Any, Callable, Mapping, TypeVar

import numpy as np
from numpy import bool_, float64, int32, int64, uint32
from numpy.typing import ArrayLike, NDArray

from . import _granular
from .arrays import ids_of, numbers, whole
from .boundary import Boundary
from .errors import InvalidInput, UsageError
from .results import Contacts, Removed, Totals

Source = str | os.PathLike[str] | dict[str, Any]
Function = TypeVar("Function", bound=Callable[..., Any])


class World:
    """Spheres, boundaries and contact laws, with explicit time integration.

    Args:
        case: one of

            - the path of a case file (JSON), or the name of a built-in case, see cases(),
            - a dict with the content of a case file.
        set: changes of the case, from JSON pointers to values: {"/end": 2}.
        folder: folder of the files that the case names by relative paths; default: the current one.
        threads: number of threads, without influence on the results.
        device: "cpu", "cuda" or "cuda:N"; GPUs need a build with CUDA.
        seed: seed of the random numbers of the first fill; the next ones have seed + 1, ...
        force: accept a step above the stability limit.
        allow_paths: accept files that are not below the folder of the case.
        watch: end with NumericalFailure if overlaps become too large or contacts create energy.

    The keys of a case are those of docs/reference/case-file.md. The particles are inserted when the world is made.
    The states are bitwise those of `hilda-granular CASE`, which computes the same steps in the same order.

    A world is used by one thread at a time; several worlds may compute in several threads. A NumericalFailure is
    the end of a world.

    Raises:
        InvalidInput: with the place in the case.
        NotAvailable: the device.
    """

    def __init__(self, case: Source, *, set: Mapping[str, Any] | None = None, folder: str | os.PathLike[str] = "",
                 threads: int = 1, device: str = "cpu", seed: int | None = None, force: bool = False,
                 allow_paths: bool = False, watch: bool = True) -> None:
        threads = whole("World: threads", threads, 1, 1024)
        seed = None if seed is None else whole("World: seed", seed, 0, 2**53 - 1)
        base = os.fspath(folder)
        if isinstance(case, dict):
            text, file, below = json.dumps(_json(case), indent=1), "case", base
        else:
            file = os.fspath(case)
            text, is_file = _granular._text_of(file)
            below = base or (os.path.dirname(file) if is_file else "")
        changes = [f"{pointer}={json.dumps(_json(value))}" for pointer, value in (set or {}).items()]
        self._core = _granular._World(text, file, changes, "" if allow_paths else os.path.abspath(below), base, seed, threads,
                                      device, force, watch)
        self._functions: list[Callable[[World], Any]] = []
        self._is_ended = False

    # time

    @property
    def name(self) -> str:
        """Name of the case."""
        return self._core.name

    @property
    def t(self) -> float:
        """Time [s]."""
        return self._core.t

    @property
    def steps(self) -> int:
        """Number of computed steps."""
        return self._core.steps

    @property
    def h(self) -> float:
        """Step [s]."""
        return self._core.h

    @property
    def end(self) -> float:
        """End time of the case [s]."""
        return self._core.end

    @property
    def stage(self) -> str | None:
        """Name of the present stage; None if the case has no stages."""
        return self._core.stage

    @property
    def warnings(self) -> list[str]:
        """Warnings of the case, of its stages and of the watch."""
        return self._core.warnings

    def to_dict(self) -> dict[str, Any]:
        """The content of the case file, with the changes."""
        content: dict[str, Any] = json.loads(self._core.text)
        return content

    def step(self, n: int = 1) -> int:
        """Computes n steps. Returns their number.

        It is less than n if the last stage of the case ends, or if a function of before_each_step() returns True.

        Other threads of Python run meanwhile. Ctrl-C raises KeyboardInterrupt between two steps, and the world can
        continue.

        Raises:
            NumericalFailure: a particle is lost, forces are not finite, ...
            UsageError: another thread uses the world, or it has failed before.
        """
        if operator.index(n) < 0:
            raise InvalidInput(f"World.step: n must not be negative, got {n}")
        return self._core.advance(min(operator.index(n), 2**62), self._before if self._functions else None)

    def before_each_step(self, function: Function) -> Function:
        """Calls function(world) before each step, at the time of its beginning. Returns the function.

        It may set velocities and loads of boundaries and particles, and add particles. step() and run() end before
        the step if it returns True. A call takes about 1 us. An exception reaches the caller with the time as a
        note; the world can continue.
        """
        self._functions.append(function)
        return function

    def _before(self) -> bool:
        for function in self._functions:
            try:
                if function(self):
                    self._is_ended = True
                    return True
            except BaseException as error:
                error.add_note(f"in the function before the step at t = {self.t:.9g} s")
                raise
        return False

    def run(self, end: float | None = None, *, interval: float | None = None,
            observer: Callable[[World], Any] | None = None) -> World:
        """Computes the steps up to a time, and returns the world.

        Args:
            end: time [s]; default: that of the case.
            interval: time between calls of the observer [s]; default: that of the rows of the case.
            observer: function that is called with the world now, after each interval, counted from now, and at the
                end. The run ends if it returns True.

        The number of steps is the nearest to end/h. The run also ends with the last stage.
        """
        h, first = self.h, self.steps
        for name, value in (("end", end), ("interval", interval)):
            if value is not None and not (np.isfinite(value) and value > 0):
                raise InvalidInput(f"World.run: {name} must be positive, got {value}")
        last = round((self.end if end is None else end) / h)
        if last < first:
            raise InvalidInput(f"World.run: end must not be before the present time, {self.t:g} s, got {end} s")
        every = max(1, round((self._core.interval if interval is None else interval) / h)) if observer is not None else last
        self._is_ended = observer is not None and self._is_seen(observer)
        while self.steps < last and not self._is_ended:
            wanted = min(every, last - self.steps)
            is_over = self.step(wanted) < wanted
            if observer is not None and not self._is_ended and self._is_seen(observer):
                self._is_ended = True
            if is_over:
                break
        if self.steps == last and self.t > self.end - 0.5 * h:  # a shorter run may be continued
            self._core.end_run()
        return self

    def _is_seen(self, observer: Callable[[World], Any]) -> bool:
        try:
            return bool(observer(self))
        except BaseException as error:
            error.add_note(f"in the observer at t = {self.t:.9g} s")
            raise

    # particles

    def __len__(self) -> int:
        """Number of particles."""
        return self._core.count

    @property
    def id(self) -> NDArray[uint32]:
        """Ids, ascending: the rows of all arrays of particles have this order; shape (n,).

        Arrays of particles are those of the present instant, and read-only. They are filled in one pass when they
        are asked for: the world has particles in cells, with positions as whole numbers and velocities in single
        precision with a remainder, so that there is no array to share. They stay valid and unchanged; after a step
        there are new ones.
        """
        array: NDArray[uint32] = self._core.properties()["id"]
        return array

    @property
    def r(self) -> NDArray[float64]:
        """Centres [m], global frame; shape (n, 3). r, v, omega and e are filled by one pass."""
        return self._core.motion()["r"]

    @property
    def v(self) -> NDArray[float64]:
        """Velocities [m/s], global frame; shape (n, 3)."""
        return self._core.motion()["v"]

    @property
    def omega(self) -> NDArray[float64]:
        """Angular velocities [rad/s], global frame; shape (n, 3)."""
        return self._core.motion()["omega"]

    @property
    def e(self) -> NDArray[float64]:
        """Euler parameters from the body frames to the global frame; shape (n, 4).

        The case must have `"orientation": true`.
        """
        if not self._core.has_orientation:
            raise UsageError('World.e: the case does not integrate orientations; it needs "orientation": true')
        return self._core.motion()["e"]

    @property
    def radius(self) -> NDArray[float64]:
        """Radii [m]; shape (n,). radius, id and all properties below are filled by one pass."""
        array: NDArray[float64] = self._core.properties()["radius"]
        return array

    @property
    def mass(self) -> NDArray[float64]:
        """Masses [kg]; shape (n,). The mass of a clump is divided among its spheres."""
        array: NDArray[float64] = self._core.properties()["mass"]
        return array

    @property
    def material(self) -> NDArray[int32]:
        """Numbers of the materials, indices into `materials`; shape (n,)."""
        array: NDArray[int32] = self._core.properties()["material"]
        return array

    @property
    def group(self) -> NDArray[int32]:
        """Numbers of the groups, indices into `groups`, -1 without a group; shape (n,)."""
        array: NDArray[int32] = self._core.properties()["group"]
        return array

    @property
    def replica(self) -> NDArray[int32]:
        """Numbers of the replicas; shape (n,)."""
        array: NDArray[int32] = self._core.properties()["replica"]
        return array

    @property
    def fixed(self) -> NDArray[bool_]:
        """Whether the centres do not move; shape (n,)."""
        array: NDArray[bool_] = self._core.properties()["fixed"]
        return array

    @property
    def clump(self) -> NDArray[int64]:
        """Ids of the first particles of the clumps, -1 without a clump; shape (n,)."""
        array: NDArray[int64] = self._core.properties()["clump"]
        return array

    @property
    def materials(self) -> list[str]:
        """Names of the materials."""
        return self._core.materials

    @property
    def groups(self) -> list[str]:
        """Names of the groups."""
        return self._core.groups

    def set_force(self, ids: ArrayLike, F: ArrayLike) -> None:
        """Sets applied forces on particles.

        Args:
            ids: ids of the particles; shape (n,), or one id.
            F: forces [N], global frame; shape (n, 3), or (3,) for all. They stay constant until the next call.
        """
        which = ids_of("World.set_force", ids)
        self._core.set_force(which, numbers("World.set_force: F", F, len(which), 3))

    def set_velocity(self, ids: ArrayLike, v: ArrayLike, omega: ArrayLike | None = None) -> None:
        """Sets velocities of particles that are in no clump.

        Args:
            ids: ids of the particles; shape (n,), or one id.
            v: velocities [m/s], global frame; shape (n, 3), or (3,) for all.
            omega: angular velocities [rad/s], global frame; the same shapes; None: they remain.
        """
        which = ids_of("World.set_velocity", ids)
        self._core.set_velocity(which, numbers("World.set_velocity: v", v, len(which), 3),
                                None if omega is None else numbers("World.set_velocity: omega", omega, len(which), 3))

    def add(self, r: ArrayLike, radius: ArrayLike, *, material: int | str = 0, v: ArrayLike = (0, 0, 0),
            omega: ArrayLike = (0, 0, 0), mass: ArrayLike = 0, e: ArrayLike = (1, 0, 0, 0), fixed: bool = False, replica: int = 0,
            group: str = "") -> NDArray[uint32]:
        """Adds particles at the present instant, and returns their ids; shape (n,).

        Args:
            r: centres [m], global frame; shape (n, 3), or (3,) for one particle.
            radius: radii [m]; shape (n,), or one number.
            material: name or number of the material.
            v, omega: velocities [m/s] and angular velocities [rad/s], global frame; shape (n, 3) or (3,).
            mass: masses [kg], shape (n,), or one number; 0: from the density.
            e: Euler parameters from the body frames to the global frame; shape (n, 4) or (4,).
            fixed: the centres do not move, and omega stays constant.
            replica: number of the replica.
            group: name of a group of the case; default: none.

        A step above the stability limit with these particles is a warning. Overlaps with other particles and boundaries
        may be at most 5 % of the smaller radius. The particles are all
        added, or none: an error leaves the world unchanged.
        """
        where = "World.add"
        try:
            shape = np.shape(r)
        except ValueError as error:  # lists of different lengths
            raise InvalidInput(f"{where}: r: must be an array of numbers: {error}") from None
        rows = shape[0] if len(shape) == 2 else 1
        index = self._material(material)
        replica = whole(f"{where}: replica", replica, 0, 2**16 - 1)
        if not isinstance(group, str):
            raise InvalidInput(f"{where}: group must be a name, got {group!r}")
        first = self._core.add(numbers(f"{where}: r", r, rows, 3), numbers(f"{where}: radius", radius, rows),
                               numbers(f"{where}: v", v, rows, 3), numbers(f"{where}: omega", omega, rows, 3),
                               numbers(f"{where}: mass", mass, rows), numbers(f"{where}: e", e, rows, 4),
                               index, fixed, replica, group)
        return np.arange(first, first + rows, dtype=uint32)

    def _material(self, material: int | str) -> int:
        names = self.materials
        if isinstance(material, str) and material in names:
            return names.index(material)
        if isinstance(material, str):
            raise InvalidInput(f"World.add: no material {material!r}; the materials are {', '.join(names)}")
        return whole("World.add: the number of the material", material, 0, len(names) - 1)

    def remove(self, ids: ArrayLike) -> None:
        """Removes particles with these ids; shape (n,), or one id. A clump is removed as a whole."""
        self._core.remove(ids_of("World.remove", ids))

    def take_removed(self) -> Removed:
        """The particles that were removed since the last call: by remove(), by a stage, or through an open side.

        They take 150 bytes each until they are taken.
        """
        return Removed(**self._core.take_removed())

    # contacts and boundaries

    def contacts(self) -> Contacts:
        """The contacts at t, as arrays. Forces are computed from the present state."""
        return Contacts(**self._core.contacts())

    def totals(self) -> Totals:
        """Energies, momentum, stress, and the loads on the boundaries at t."""
        return Totals(**self._core.totals())

    @property
    def boundaries(self) -> list[str]:
        """Names of the boundaries, by number."""
        return self._core.boundaries

    def boundary(self, which: str | int) -> Boundary:
        """A boundary, by its name or number."""
        if isinstance(which, str):
            return Boundary(self._core, self._core.number_of(which))
        return Boundary(self._core, whole("World.boundary: the number", which, 0, len(self.boundaries) - 1))

    @property
    def gravity(self) -> NDArray[float64]:
        """Acceleration of gravity [m/s^2], global frame; shape (3,). Can be set as a whole."""
        return self._core.gravity

    @gravity.setter
    def gravity(self, value: ArrayLike) -> None:
        self._core.gravity = numbers("World.gravity", value, None, 3)

    def __repr__(self) -> str:
        return f"<hilda_granular.World {self.name}: {len(self)} particles, t = {self.t:g} s>"


def run(case: Source, *, end: float | None = None, interval: float | None = None,
        observer: Callable[[World], Any] | None = None, **options: Any) -> World:
    """Makes a World and computes its steps: see World.run(). The options are those of World. Returns the world."""
    return World(case, **options).run(end, interval=interval, observer=observer)


def cases() -> dict[str, str]:
    """The built-in cases, as a dict from their names to their descriptions."""
    return dict(_granular._cases())


def _json(value: Any) -> Any:
    """A copy that consists of the types of JSON. NumPy arrays become lists."""
    return json.loads(json.dumps(value, default=_listed))


def _listed(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return value.tolist()
    raise InvalidInput(f"a case cannot contain a {type(value).__name__}, got {value!r}")
