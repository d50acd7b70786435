#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 26: functions of a model in Python that return wrong values, raise or interfere.

12 functions (force, potential, phi, variation, nu, gamma of a constraint, four of a surface, observer, step of an
integrator) x 20 ways to be wrong, in the first call or in a later one. The process ends by itself; a function that raises
reaches the caller with its own exception; another one raises or leaves a result whose numbers are finite.
"""
import os
import subprocess
import sys

import matrix

SCRIPT = r'''
import sys, gc
import numpy as np
import hilda

of, how, first = sys.argv[1], sys.argv[2], int(sys.argv[3])

class Own(BaseException):
    pass

class BadArray:
    def __array__(self, *a, **k):
        raise TypeError("no array")

calls = 0

def wrong(right, x=None):
    """The right value until the call `first`, then the wrong one"""
    global calls
    calls += 1
    if calls < first:
        return right
    value = np.asarray(right, dtype=float)
    if how == "none": return None
    if how == "text": return "text"
    if how == "nan": return np.full_like(value, np.nan)
    if how == "inf": return np.full_like(value, np.inf)
    if how == "large": return np.full_like(value, 1e300)
    if how == "shape": return np.ones((7, 5))
    if how == "empty": return []
    if how == "ragged": return [[1], [2, 3]]
    if how == "complex": return value * 1j + 1j
    if how == "object": return BadArray()
    if how == "generator": return (v for v in [1, 2])
    if how == "bytes": return b"\x00" * 24
    if how == "ValueError": raise ValueError("own text")
    if how == "KeyboardInterrupt": raise KeyboardInterrupt("own text")
    if how == "SystemExit": raise SystemExit(3)
    if how == "Own": raise Own("own text")
    if how == "recursion":
        def f(n): return f(n + 1) + 1
        return f(0)
    if how == "write":
        (x if x is not None else state[0]).r[:] = 1
        return right
    if how == "run":
        if calls < first + 3: hilda.run("double_pendulum", end=0.002)
        return right
    if how == "step":
        simulation[0].step()
        return right
    raise AssertionError(how)

state, simulation = [None], [None]
model = hilda.Model(name="m", gravity=[0, 0, -9.81], end=0.05)
model.body("a", mass=1, inertia=[0.1, 0.1, 0.1], r=[0, 0, 0.1])
options = {}

def force(x):
    state[0] = x
    right = np.zeros((1, 3))
    return wrong(right, x) if of == "force" else right

def potential(x):
    return wrong(0.0, x) if of == "potential" else 0.0

def phi(x):
    right = [x.r[1][0]]
    return wrong(right, x) if of == "phi" else right

def variation(x):
    right = (np.zeros((1, 6)), np.array([[1., 0, 0, 0, 0, 0]]))
    return (right[0], wrong(right[1], x)) if of == "variation" else right

def nu(x):
    return wrong([0.0], x) if of == "nu" else [0.0]

def gamma(x):
    return wrong([0.0], x) if of == "gamma" else [0.0]

class Ball(hilda.Surface):
    size = 0.1
    def value(self, a):
        right = 0.5 * (a @ a / 0.1 - 0.1)
        return wrong(right) if of == "value" else right
    def gradient(self, a):
        return wrong(a / 0.1) if of == "gradient" else a / 0.1
    def hessian(self, a):
        return wrong(np.eye(3) / 0.1) if of == "hessian" else np.eye(3) / 0.1
    def support(self, u):
        return wrong(0.1 * u) if of == "support" else 0.1 * u

class Own1(hilda.Integrator):
    order = 1
    def step(self, x, h):
        state[0] = x
        x.rdot[:] += h * np.array([0, 0, -9.81])
        x.r[:] += h * x.rdot
        if of == "integrator":
            value = wrong(x.r.copy())
            x.r[:] = value

def observer(x):
    state[0] = x
    return wrong(False, x) if of == "observer" else None

integrator = "rA-half-1"
if of in ("force", "potential", "observer"):
    model.force(force, potential=potential)
elif of in ("phi", "variation", "nu", "gamma"):
    model.constraint(phi, body_i="ground", body_j="a", name="c", variation=variation, nu=nu, gamma=gamma)
elif of in ("value", "gradient", "hessian", "support"):
    model.contact(name="c", body_i="a", body_j="ground", surface_i=Ball(), surface_j={"type": "plane"},
                  normal={"type": "hooke", "stiffness": 1e4})
elif of == "integrator":
    integrator = Own1
try:
    if how == "step":
        simulation[0] = hilda.Simulation(model, integrator, step=1e-3)
        if of == "observer":
            result = model.run(integrator, step=1e-3, observer=observer)
        else:
            while simulation[0].step(): pass
            result = None
    else:
        result = model.run(integrator, step=1e-3, observer=observer) if of == "observer" else model.run(integrator, step=1e-3)
    fine = result is None or all(np.isfinite(v).all() for v in (result.r, result.rdot, result.omega_bar))
    print("FINISHED", fine)
except BaseException as e:
    print("RAISED", type(e).__name__, str(e).replace("\n", " ")[:200])
gc.collect()
# the interpreter and the library still work
again = hilda.run("double_pendulum", end=0.01)
print("AGAIN", np.isfinite(again.r).all())
'''
FUNCTIONS = ["force", "potential", "phi", "variation", "nu", "gamma", "value", "gradient", "hessian", "support", "observer", "integrator"]
RAISE = ["ValueError", "KeyboardInterrupt", "SystemExit", "Own", "recursion"]
WAYS = ["none", "text", "nan", "inf", "large", "shape", "empty", "ragged", "complex", "object", "generator", "bytes", *RAISE, "write", "run",
        "step"]


def main():
    row = matrix.Row("26 Python functions")
    environment = dict(row.environment, PYTHONPATH=str(row.build / "python"), PYTHONDONTWRITEBYTECODE="1", OMP_NUM_THREADS="1")
    # The package needs NumPy, which the interpreter of the system has.
    python = "/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable
    with matrix.scratch() as folder:
        (folder / "hostile.py").write_text(SCRIPT)
        for of in FUNCTIONS:
            for how in WAYS:
                for first in (1, 40):
                    ended = row.run([python, "hostile.py", of, how, first], cwd=folder, limit=60, env=environment, stdin=subprocess.DEVNULL)
                    lines = ended.out.strip().split("\n")
                    fine = ended.code == 0 and len(lines) == 2 and lines[1] == "AGAIN True"
                    if fine and lines[0].startswith("RAISED"):
                        kind = lines[0].split()[1]
                        fine = kind == {"recursion": "RecursionError"}.get(how, how) if how in RAISE else kind not in (
                            "SystemError", "RuntimeError", "MemoryError", "AssertionError")
                    elif fine:
                        fine = lines[0] == "FINISHED True"
                    row.case(f"{of} {how} {first}", fine, f"exit {ended.code}: {ended.out} {ended.err[-300:]}")
    row.end()


main()
