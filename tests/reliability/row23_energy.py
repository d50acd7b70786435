#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 23: no run of a random passive model that ends with exit code 0 gains energy beyond the error of its scheme.

60 models, from the seeds 0 to 59: trees of bodies with joints, springs and dampers, every second tree with implicit ones
that are 100 times as stiff; bodies thrown on a floor with Hertz and Hooke contacts and every friction law; balls in a
bowl with the contact as a constraint. Each runs with every integrator of fixed step and with ida-rp; the number of steps
is between 200 and 20000. The energy of a passive model never rises. From trajectory.csv, with a row for each step, the
script computes independently of the program

    rise  the largest rise of the energy above its lowest value so far
    T     the largest kinetic energy
    B     the largest kinetic energy of the velocity change of a step, h²/2 v̇ᵀ M v̇

and requires rise <= T/100 + the smaller of B and T/4 + rounding, unless the energy of the scheme is known to drift. A
run with exit code 4 gave no answer and passes, but half of the runs at least must give one; a combination that is
refused is no case. The energy in the rows does not contain the springs of friction; their largest energy, (mu N)²/(2 K),
is added to the limit.
"""
import concurrent.futures
import csv
import json
import math
import random

import matrix

DRIFTS = {"rA-half-1", "rA-half-1-kick", "rA-half-2", "rA-half-2-bdf2",
          "rp-half-1", "rp-half-1-kick", "reps-half-1", "reps-half-1-kick"}


def inertia(rng, mass, size):
    a, b, c = (size * rng.uniform(0.5, 1.5) for _ in range(3))
    return [mass / 12 * (b * b + c * c), mass / 12 * (a * a + c * c), mass / 12 * (a * a + b * b)]


def unit(rng):
    while True:
        v = [rng.gauss(0, 1) for _ in range(3)]
        n = math.sqrt(sum(x * x for x in v))
        if n > 0.1:
            return [x / n for x in v]


def tree(rng):
    """Bodies below each other, joined by spherical, revolute, universal or translational joints."""
    bodies, constraints, forces = [], [], []
    count = rng.randint(1, 5)
    length = 10 ** rng.uniform(-1, 0.5)
    for k in range(count):
        mass = 10 ** rng.uniform(-1, 2)
        bodies.append({"name": f"b{k}", "mass": mass, "inertia": inertia(rng, mass, length),
                       "r": [length * (k + 1), 0, 0]})
        joint = rng.choice(["spherical", "revolute", "revolute", "universal", "fixed" if k else "spherical"])
        c = {"name": f"j{k}", "type": joint, "body_i": "ground" if k == 0 else f"b{k - 1}", "body_j": f"b{k}"}
        if joint != "fixed":
            c["s_bar_p_i"] = [length * 0.5 if k == 0 else length / 2, 0, 0]
            c["s_bar_q_j"] = [-length / 2, 0, 0]
        if joint == "revolute":
            c["axis_bar_i"] = c["axis_bar_j"] = unit(rng)
        if joint == "universal":
            c["axis_bar_i"], c["axis_bar_j"] = [0, 1, 0], [0, 0, 1]
        constraints.append(c)
        stiffness = mass * 10 ** rng.uniform(0, 3)
        if rng.random() < 0.5:
            forces.append({"type": "spring-damper", "name": f"s{k}", "body_i": "ground", "body_j": f"b{k}",
                           "s_bar_p_i": [length * (k + 1), length, length], "stiffness": stiffness,
                           "damping": rng.choice([0, 0.05, 0.3]) * math.sqrt(stiffness * mass),
                           "free_length": length * rng.uniform(0.5, 1.5)})
        elif rng.random() < 0.3:
            k_r = mass * 9.81 * length * rng.uniform(0.1, 3)
            if joint == "revolute":
                forces.append({"type": "torsion-spring", "name": f"t{k}", "body_i": c["body_i"], "body_j": f"b{k}",
                               "axis_bar_i": c["axis_bar_i"], "axis_bar_j": c["axis_bar_j"],
                               "stiffness": k_r, "free_angle": 0})
    return {"bodies": bodies, "constraints": constraints, "forces": forces}, 3


NO_ANSWER = "exit code"
FRICTION = [None,
            {"mu_s": 0.3, "mu_k": 0.25, "zeta": 0.5},
            {"mu_s": 0.5, "zeta": 1, "eta_r": 0.05, "eta_psi": 0.05},
            {"law": "epsd", "mu_s": 0.4, "zeta": 0.5, "mu_r": 0.02},
            {"law": "constant-torque", "mu_s": 0.4, "mu_r": 0.02}]


def thrown(rng):
    """A ball or ellipsoid thrown on a floor, or two balls, with a Hertz or Hooke contact."""
    R, mass = 10 ** rng.uniform(-2, 0), 10 ** rng.uniform(-2, 2)
    weight = mass * 9.81
    semi = [R * rng.uniform(0.7, 1.3) for _ in range(3)]
    shape = rng.choice([{"type": "sphere", "radius": R}, {"type": "ellipsoid", "semi_axes": semi}])
    radii = [R] * 3 if shape["type"] == "sphere" else semi
    J = [mass / 5 * (radii[1] ** 2 + radii[2] ** 2), mass / 5 * (radii[0] ** 2 + radii[2] ** 2),
         mass / 5 * (radii[0] ** 2 + radii[1] ** 2)]
    speed = math.sqrt(9.81 * R)
    height = max(radii) * rng.uniform(1, 3)
    stiffness = weight / (0.002 * R)
    restitution = rng.choice([1, 0.8, 0.3])
    normal = ({"type": "hooke", "stiffness": stiffness, "restitution": restitution} if rng.random() < 0.5 else
              {"type": "hertz", "E_star": weight / (4 / 3 * R ** 2 * 0.002 ** 1.5), "restitution": restitution})
    contact = {"name": "floor", "body_i": "a", "body_j": "ground", "surface_i": shape,
               "surface_j": {"type": "plane"}, "normal": normal}
    friction = rng.choice(FRICTION)
    if friction:
        contact["friction"] = dict(friction, K_E=stiffness * rng.uniform(0.1, 1))
    return {"bodies": [{"name": "a", "mass": mass, "inertia": J, "r": [0, 0, height],
                        "r_dot": [speed * rng.uniform(-2, 2), speed * rng.uniform(-2, 2), speed * rng.uniform(-1, 2)],
                        "omega": [rng.uniform(-3, 3) * speed / R for _ in range(3)]}],
            "contacts": [contact]}, 8 * math.sqrt(R / 9.81)


def rolling(rng):
    """A ball in an ellipsoidal bowl, or a body on the floor, with a contact as a constraint."""
    mass, R = 10 ** rng.uniform(-1, 1), rng.uniform(0.2, 0.6)
    friction = rng.choice([None, {"law": "rolling"},
                           {"law": "implicit", "mu_s": 0.3, "mu_k": 0.25, "K_E": 1e4 * mass, "K_D": 10 * mass},
                           {"law": "implicit", "mu_s": 0.6, "K_E": 1e4 * mass, "K_D": 10 * mass, "eta_r": 0.05},
                           {"mu_s": 0.3, "K_E": 2e3 * mass, "zeta": 0.5}])
    normal = {"type": "constraint"}
    if rng.random() < 0.5:
        normal.update(unilateral=True, restitution=rng.choice([0, 0.5]))
    contact = {"name": "bowl", "body_i": "ball", "body_j": "ground", "surface_i": {"type": "sphere", "radius": R},
               "surface_j": {"type": "ellipsoid", "semi_axes": [4, 3, 2], "concave": True}, "normal": normal}
    if friction:
        contact["friction"] = friction
    J = 0.4 * mass * R * R
    return {"bodies": [{"name": "ball", "mass": mass, "inertia": [J, J, J], "r": [0, 0, -2 + R],
                        "r_dot": [rng.uniform(-2, 2), rng.uniform(-2, 2), 0],
                        "omega": [0, 0, 0] if friction and friction.get("law") == "rolling" else
                        [rng.uniform(-5, 5) for _ in range(3)]}],
            "contacts": [contact]}, 3


def model(seed):
    rng = random.Random(seed)
    parts, end = [tree, thrown, rolling][seed % 3](rng)
    text = {"hilda_model": 1, "name": f"random_{seed}", "end": end}
    text.update(parts)
    if seed % 6 == 3:
        for force in text["forces"]:
            force.update(implicit=True, stiffness=100 * force["stiffness"])
    text["end"] = end = float(f"{end:.2g}")
    return text, end / round(10 ** rng.uniform(2.3, 4.3))


def gains(folder, text, h):
    """rise, T, B, the rounding of the energy and the largest energy of the springs of friction, from the rows"""
    with open(folder / "trajectory.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    if len(rows) < 18:
        return None
    lowest, rise, T_most, B_most, size, N_most = math.inf, 0.0, 0.0, 0.0, 0.0, 0.0
    for n, row in enumerate(rows):
        T = B = 0.0
        for body in text["bodies"]:
            name, m, J = body["name"], body["mass"], body["inertia"]
            N_most = max(N_most, m * math.hypot(float(row[f"{name}.ax"]), float(row[f"{name}.ay"]),
                                                float(row[f"{name}.az"]) + 9.81))
            T += m * sum(float(row[f"{name}.v{c}"]) ** 2 for c in "xyz")
            B += m * sum(float(row[f"{name}.a{c}"]) ** 2 for c in "xyz")
            T += sum(J[k] * float(row[f"{name}.w{c}"]) ** 2 for k, c in enumerate("xyz"))
            B += sum(J[k] * float(row[f"{name}.al{c}"]) ** 2 for k, c in enumerate("xyz"))
        E = float(row["energy"])
        lowest = min(lowest, E)
        if n >= 16:
            rise = max(rise, E - lowest)
        T_most, B_most, size = max(T_most, T / 2), max(B_most, h * h * B / 2), max(size, abs(E) + T)
    laws = [contact.get("friction", {}) for contact in text.get("contacts", [])]
    friction = sum((law["mu_s"] * N_most) ** 2 / 2 / law["K_E"] for law in laws if law.get("K_E"))
    return rise, T_most, B_most, 1e-7 * size, friction


def check(row, seed, scheme):
    """(whether it is a case, whether it passes, text)"""
    text, h = model(seed)
    with matrix.scratch() as folder:
        (folder / "m.json").write_text(json.dumps(text))
        step = ["--interval", repr(h)] if scheme == "ida-rp" else ["--step", repr(h), "--interval", "0"]
        ended = row.run([row.hilda, "run", "m.json", "--integrator", scheme, "--output", "out", "--fix-initial",
                         "--quiet"] + step, cwd=folder)
        if ended.code in (2, 3):
            return False, True, ""
        if ended.code != 0:
            return True, ended.code == 4, f"{NO_ANSWER} {ended.code}: {ended.last_error()}"
        rise, T, B, rounding, friction = gains(folder / "out", text, h)
        limit = 0.01 * T + min(B, T / 4) + friction + rounding
        why = f"rise {rise:.3g} J, limit {limit:.3g} J, T {T:.3g} J, B {B:.3g} J, h {h:g} s"
        return True, scheme in DRIFTS or rise <= limit, why


def main():
    row = matrix.Row("23 energy of random passive models",
                     lambda parser: parser.add_argument("--models", type=int, default=60))
    lines = row.run([row.hilda, "integrators"]).out.split("\n")[1:]
    schemes = [line.split()[0] for line in lines if any(f" {name} " in line for name in ("rA", "rp", "reps"))]
    schemes = [scheme for scheme in schemes if not scheme.startswith("ida-rp-")]
    tasks = [(seed, scheme) for seed in range(row.options.models) for scheme in schemes]
    answers = 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for (seed, scheme), (is_case, passed, why) in zip(tasks, pool.map(lambda task: check(row, *task), tasks)):
            if is_case:
                row.case(f"seed {seed}, {scheme}", passed, why)
                answers += not why.startswith(NO_ANSWER)
    row.case("half of the runs give an answer", 2 * answers >= row.cases, f"{answers} of {row.cases}")
    row.end()


main()
