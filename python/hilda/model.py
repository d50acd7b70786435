# SPDX-License-Identifier: GPL-3.0-or-later
"""Models of mechanisms."""

from __future__ import annotations

import json
import os
import threading
from typing import Any, Callable, Iterable, Mapping

from . import _hilda
from ._hilda import State
from .errors import InvalidInput, UsageError
from .integrator import Integrator
from .result import Result
from .settings import settings_as_text
from .surface import Surface
from .warn import warn

_one_start = threading.RLock()
_keywords = ("integrator", "end", "step", "interval", "reactions", "columns", "observer", "force")  # of run
Source = str | os.PathLike[str] | dict[str, Any]


class Model:
    """A mechanism: bodies, constraints, forces and contacts.

    Args:
        source: one of

            - the path of a model file (JSON), or the name of a built-in model, see problems(),
            - a dict with the content of a model file,
            - None: an empty model, which body(), constraint(), force() and contact() extend.
        set: changes of the model, from JSON pointers to values: {"/bodies/0/mass": 2}.
        folder: folder of the files that a dict names by relative paths; default: the current one.
        fix_initial: project initial data that violate the constraints, instead of refusing them.
        allow_paths: accept files that a model file names and that are not below its folder. A dict may name any file.
        **keys: keys of an empty model, such as gravity=[0, 0, -9.81], name="arm", end=2.

    The keys of bodies, constraints, forces and contacts are those of the model file, see
    docs/reference/model-file.md. They are checked when the model is used for the first time: all errors are
    InvalidInput with the place in the model.
    """

    def __init__(self, source: Source | None = None, *, set: Mapping[str, Any] | None = None,
                 folder: str | os.PathLike[str] = "", fix_initial: bool = False, allow_paths: bool = False,
                 **keys: Any) -> None:
        if source is not None and keys:
            raise UsageError("Model: the keys " + ", ".join(keys) + " are for a new model, without a source")
        self._name: str | None = None
        self._data: dict[str, Any] | None = None
        if source is None:
            self._data = {"hilda_model": 1, "name": "model", **_json(keys)}
        elif isinstance(source, dict):
            self._data = _json(source)
        else:
            self._name = os.fspath(source)
        self._set = [f"{pointer}={json.dumps(_json(value))}" for pointer, value in (set or {}).items()]
        self._folder = os.fspath(folder)
        self._fix_initial = fix_initial
        self._allow_paths = allow_paths
        self._within = ""  # folder of the files of a model file that has become a dict
        self._forces: _hilda._Forces = []
        self._constraints: _hilda._Constraints = []
        self._surfaces: list[Surface] = []
        self._started: _hilda._Model | None = None
        self._starting = False

    def body(self, name: str, **keys: Any) -> Model:
        """Adds a body. Keys: mass [kg], inertia [kg m^2], r [m], and others of the model file."""
        return self._add("bodies", {"name": name, **keys})

    def constraint(self, type: str | Callable[[State], Any], **keys: Any) -> Model:
        """Adds a joint, a driver or another constraint of this type, such as "revolute", or a function of two bodies.

        A function `phi(x)` returns the position rows, shape (rows,), which are zero. x is a State with two bodies: x.r[0],
        x.A[0] are of body i, x.r[1], x.A[1] of body j; x.t is the time. The ground is at rest at the origin.

        Keys of a function:

        - body_i, body_j: names; one may be "ground".
        - rows: number of rows, 1 to 8; default 1.
        - name: default: that of the function.
        - variation(x): (C_i, C_j), shapes (rows, 6): derivatives of the rows by r (global frame) and by the rotation
          theta (body frame: A changes by A tilde(theta)) of body i and of body j.
        - nu(x): minus the derivative by time, shape (rows,).
        - gamma(x): gamma in C (rddot, omegadot_bar) = gamma, the second time derivative of the rows; shape (rows,).

        Functions that are not given are computed by differences, with relative errors of about 1e-9 if the rows change
        smoothly over lengths of 1 mm and more. Those that are given are compared with differences at the start: each run
        has a SimulationWarning for one that is wrong. nu and gamma by differences are refused where the estimated error
        exceeds 1e-5. The functions must be defined a little outside of the run, also before its start. A call takes about
        2 us, and differences take 48 of them for `variation`.
        """
        if not callable(type):
            return self._add("constraints", {"type": type, **keys})
        name = keys.pop("name", getattr(type, "__name__", "constraint"))
        try:
            body_i, body_j = keys.pop("body_i"), keys.pop("body_j")
        except KeyError as missing:
            raise UsageError(f"constraint '{name}': missing key {missing}") from None
        rows = keys.pop("rows", 1)
        functions = [keys.pop(key, None) for key in ("variation", "nu", "gamma")]
        if keys:
            raise UsageError(f"constraint '{name}': unknown keys {', '.join(keys)}; a function has name, body_i, body_j, rows, "
                             "variation, nu and gamma")
        self._constraints.append((name, body_i, body_j, rows, type, functions[0], functions[1], functions[2]))
        self._started = None
        return self

    def force(self, type: str | Callable[[State], Any], **keys: Any) -> Model:
        """Adds a force of this type, such as "spring-damper", or a function of the state.

        A function `force(state)` returns F, or (F, n_bar): arrays of the shape (bodies, 3) with the forces
        [N, global frame, at the centres of mass] and the torques [N m, body frames] of all bodies. It is called
        for each evaluation of the loads, which takes about 2 us. Keys: name, and potential, a function of the
        state that returns the potential energy [J]. Implicit integrators do not differentiate it.
        """
        if callable(type):
            name = keys.pop("name", getattr(type, "__name__", "force"))
            potential = keys.pop("potential", None)
            if keys:
                raise UsageError(f"force '{name}': unknown keys {', '.join(keys)}; a function has name and potential")
            self._forces.append((name, type, potential))
            self._started = None
            return self
        return self._add("forces", {"type": type, **keys})

    def contact(self, **keys: Any) -> Model:
        """Adds a contact. Keys: those of the model file.

        surface_i and surface_j may be objects of a class derived from Surface, or dicts that have such an object as "type"
        beside the keys of its pose: {"type": Egg(), "position": [0, 0, 0.1]}.
        """
        for key in ("surface_i", "surface_j"):
            given = keys.get(key)
            pose: dict[str, Any] = given if isinstance(given, dict) else {"type": given}
            surface = pose.get("type")
            if isinstance(surface, Surface):
                keys[key] = {**pose, "type": "python", "number": len(self._surfaces)}
                self._surfaces.append(surface)
        return self._add("contacts", keys)

    def _add(self, group: str, entry: dict[str, Any]) -> Model:
        if self._data is None:
            assert self._name is not None
            self._data = json.loads(_hilda._text_of(self._name))
            if not self._folder and _hilda._is_path(self._name):
                self._folder = os.path.dirname(self._name)
            if _hilda._is_path(self._name) and not self._allow_paths:
                self._within = os.path.dirname(os.path.abspath(self._name))
            self._name = None
        self._data.setdefault(group, []).append(_json(entry))
        self._started = None
        return self

    def _core(self) -> _hilda._Model:
        """The model of the extension module, with a consistent start."""
        started = self._started
        if started is not None:
            return started
        with _one_start:  # another thread waits until this one has started the model
            if self._starting:
                raise UsageError("a function must not use the properties of its model while the model is started")
            if self._started is None:
                self._starting = True
                try:
                    self._started = self._read()
                finally:
                    self._starting = False
            return self._started

    def _read(self) -> _hilda._Model:
        if self._name is not None:
            return _hilda._read_named(self._name, self._set, self._forces, self._constraints, self._fix_initial,
                                      self._allow_paths)
        text = json.dumps(self._data, indent=1)
        return _hilda._read_text(text, "model", self._set, self._folder, self._within, self._forces,
                                 self._constraints, self._surfaces, self._fix_initial)

    @property
    def name(self) -> str:
        """Name of the model."""
        return self._core().name

    @property
    def end(self) -> float:
        """Default end of a run [s]."""
        return self._core().end

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies, in the order of the arrays."""
        return self._core().bodies

    @property
    def report(self) -> dict[str, Any]:
        """Rows, rank, degrees of freedom and residuals of the start, as a dict."""
        return self._core().report

    @property
    def warnings(self) -> list[str]:
        """Warnings of the reader, with their places in the model. Each run reports them as SimulationWarning."""
        return self._core().warnings

    @property
    def start(self) -> State:
        """The consistent initial State."""
        return self._core().state()

    def to_dict(self) -> dict[str, Any]:
        """The content of the model file, with defaults and changes filled in."""
        content: dict[str, Any] = json.loads(self._core().text)
        return content

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the model file. It cannot have parts that are written in Python."""
        names = [f"force '{force[0]}'" for force in self._forces] + [f"constraint '{one[0]}'" for one in self._constraints]
        if names:
            raise UsageError(f"Model.save: {names[0]} is a function; a model file cannot have it")
        if self._surfaces:
            raise UsageError(f"Model.save: the surface {type(self._surfaces[0]).__name__} is written in Python; a model file "
                             "cannot have it")
        text = self._core().text
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def run(self, integrator: str | type[Integrator] | None = None, *, end: float | None = None,
            step: float | None = None, interval: float | None = None, rtol: float | None = None,
            atol: float | None = None, max_step: float | None = None, tolerance: float | None = None,
            max_iterations: int | None = None, linear_solver: str | None = None, rho_infinity: float | None = None,
            reparametrise: bool = False, reactions: bool = False, columns: Iterable[str] = (), observer: Callable[[State], Any] | None = None, force: bool = False,
            **settings: Any) -> Result:
        """Integrates the model and returns a Result.

        Args:
            integrator: name of an integrator, see integrators(), or a class derived from Integrator; default:
                rA-half-1-momentum, for models with rigid contacts rA-moreau-1.
            end: end of the run [s]; default: that of the model.
            step: step [s]; default 1e-3 for integrators with a fixed step. Integrators with adaptive steps take
                rtol and atol instead.
            interval: time between rows of the result [s]; default: end/1000, 0: a row for each step.
            rtol, atol: tolerances of integrators with adaptive steps; default 1e-10, and atol = rtol.
            max_step: longest of their steps [s]; default: no limit.
            tolerance, max_iterations: of Newton's method; default 1e-10 and 30.
            linear_solver: "auto", the default, "klu" or "condensed".
            rho_infinity: numerical damping from 0 to 1, default 0.8, of integrators that have it.
            reparametrise: change the body frame when Euler angles approach a singular orientation, instead of
                stopping.
            reactions: store the constraint forces and torques on each body.
            columns: names of further columns (hilda help outputs), such as "spring.force"; "forces", "contacts" and
                "outputs" stand for all columns of these groups.
            observer: function of the State of each node (each row, with adaptive steps). The run ends if it
                returns True.
            force: accept a step above the stability limit of a force.
            **settings: options that integrators of plug-ins declare, such as damping for --damping.

        The events of the model are found, see Result.events. One with the action stop ends the run.

        Warnings are those of Python, of the class SimulationWarning, and in Result.warnings. Those of the steps are reported
        after a run that does not fail.

        Other threads run meanwhile. Ctrl-C ends the run: the KeyboardInterrupt has the rows up to then as
        attribute `result`.

        Raises:
            InvalidInput, UsageError: before the run.
            NumericalFailure: with the rows up to the failure as attribute `result`.
        """
        core = self._core()
        settings.update(tolerance=tolerance, max_iterations=max_iterations, linear_solver=linear_solver,
                        rho_infinity=rho_infinity, rtol=rtol, atol=atol, max_step=max_step, reparametrise=reparametrise)
        outcome = _hilda._run(core, _used("run", core, integrator), end, step, interval,
                              settings_as_text("run", _keywords, settings), force, warn, reactions,
                              [columns] if isinstance(columns, str) else list(columns), observer)
        error = outcome.pop("error")
        findings = outcome.pop("findings")
        result = Result(core, outcome)
        if error is None:
            for text in findings:
                warn(text)
            return result
        error.result = result
        try:
            raise error
        finally:
            del error  # its traceback has this frame: otherwise the arrays would remain until a garbage collection

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_started": None}  # read again after a copy or in another process

    def __repr__(self) -> str:
        if self._started is None:
            return f"<hilda.Model {self._name or (self._data or {}).get('name')}>"
        report = self.report
        return (f"<hilda.Model {self.name}: {len(self.bodies)} bodies, {report['rows']} constraint rows, "
                f"{report['degrees_of_freedom']} degrees of freedom>")


def run(model: Model | Source, integrator: str | type[Integrator] | None = None, **options: Any) -> Result:
    """Integrates a model: a Model, the path of a model file, the name of a built-in model, or a dict.

    The options are those of Model.run().
    """
    return (model if isinstance(model, Model) else Model(model)).run(integrator, **options)


def _used(where: str, core: _hilda._Model, integrator: str | type[Integrator] | None) -> str | Integrator:
    """The name of an integrator, or an object of its class; None: that of the model"""
    if integrator is None:
        return core.default_integrator
    if isinstance(integrator, str):
        return integrator
    if isinstance(integrator, type) and issubclass(integrator, Integrator):
        return integrator(_hilda.System(core))
    raise UsageError(f"{where}: an integrator must be a name or a class derived from hilda.Integrator, got {integrator!r}")


def integrators() -> dict[str, dict[str, Any]]:
    """The integrators, as a dict from their names to their properties."""
    return {scheme["name"]: scheme for scheme in _hilda._integrators()}


def problems() -> dict[str, str]:
    """The built-in models, as a dict from their names to their descriptions."""
    return dict(_hilda._problems())


def _json(value: Any) -> Any:
    """A copy that consists of the types of JSON. NumPy arrays become lists."""
    return json.loads(json.dumps(value, default=_listed))


def _listed(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return value.tolist()
    raise InvalidInput(f"a model cannot contain a {type(value).__name__}, got {value!r}")
