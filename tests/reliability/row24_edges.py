#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 24: thresholds, pulses, jumps, kinks, turns, events, assembly branches, starts and passes with closed forms.

Each kind has 60 models with random masses, lengths, times, integrators and tolerances, from the seeds 0 to 59, and one output
row at the end. A run that ends with exit code 0 has the closed form; one with another exit code gave no answer and passes,
but nine of ten runs must give one.

    stop     a body flies against a distance limit and bounces: v = -v, and the time in contact pi sqrt(m/k)
    pulse    a force of 1e-4 to 1e-2 of the run, at any time, on a body at rest: v = F w/m
    gear     a constant torque on a pair of gears, up to 300 turns: theta = T t^2/(2 J)
    kink     a prescribed motion of two speeds, with a pendulum at its end in a plane without gravity: the position
    event    a falling body, and formulas that are flat, steep, scaled or shifted: t = sqrt(2 z/g)
    branch   hilda kinematics of a slider-crank with up to 2000 rad/s: x = r cos + sqrt(l^2 - r^2 sin^2)
    hold     a body on a slope at 0.5 to 0.99 of the limit of sliding or rolling: it does not move
    pass     two balls whose paths cross within a step: the second one moves, or the run is refused
"""
import csv
import json
import math
import random

import matrix

ADAPTIVE = ["rA-dp-5", "rA-dop853", "rA-radau-5", "ida-rp"]
RAIL = {"type": "translational", "name": "rail", "body_i": "ground", "body_j": "b", "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}
SEEDS = 60


def body(name, mass, r, **more):
    return dict({"name": name, "mass": mass, "inertia": [mass, mass, mass], "r": r}, **more)


def model(bodies, constraints=(), forces=(), gravity=(0, 0, 0), **more):
    return dict({"hilda_model": 1, "name": "m", "gravity": list(gravity), "bodies": bodies, "constraints": list(constraints),
                 "forces": list(forces)}, **more)


def adaptive(rng):
    rtol = 10 ** rng.uniform(-10, -5)
    return rtol, ["--integrator", rng.choice(ADAPTIVE), "--rtol", f"{rtol:.3g}"]


def stop(rng):
    mass, speed, distance = 10 ** rng.uniform(-1, 2), 10 ** rng.uniform(-0.5, 1), 10 ** rng.uniform(-0.5, 1)
    contact = distance / speed * 10 ** rng.uniform(-4, -2)  # time in contact [s]
    stiffness = mass * (math.pi / contact) ** 2
    free = distance / speed * rng.uniform(0.3, 3)  # time of flight after it
    end = distance / speed + contact + free
    # the distance of the point of the body from one that is 1 m below the rail behind the stop
    m = model([body("b", mass, [-distance, 0, 0], r_dot=[speed, 0, 0])], [RAIL],
              [{"type": "distance-limit", "name": "stop", "body_i": "ground", "body_j": "b", "s_bar_p_i": [1000, 0, 0],
                "minimum": 1000, "stiffness": stiffness}])
    rtol, options = adaptive(rng)
    scale = 1 + speed * free + speed
    return m, end, options, lambda row: max(abs(row["b.rx"] + speed * free), abs(row["b.vx"] + speed)), 3000 * rtol * scale


def pulse(rng):
    mass, end = 10 ** rng.uniform(-1, 2), 10 ** rng.uniform(-1, 1)
    width = end * 10 ** rng.uniform(-4, -2)
    begin = rng.uniform(0, end - width)
    force = mass / width * 10 ** rng.uniform(-1, 1)
    text = rng.choice([f"if(t-{begin!r}, if(t-{begin + width!r}, 0, {force!r}), 0)",
                       f"{force!r}*step(t-{begin!r})*step({begin + width!r}-t)",
                       f"{2 * force!r}*max(0, 1-abs(t-{begin + width / 2!r})/{width / 2!r})"])
    m = model([body("b", mass, [0, 0, 0])], [RAIL],
              [{"type": "force", "name": "f", "body": "b", "frame": "global", "components": [text, 0, 0]}])
    speed = force * width / mass
    rtol, options = adaptive(rng)
    x = speed * (end - begin - width / 2)
    return m, end, options, lambda row: max(abs(row["b.rx"] - x), abs(row["b.vx"] - speed)), 3000 * rtol * (1 + speed + x)


def gear(rng):
    ratio, inertia = 10 ** rng.uniform(-1, 1), 10 ** rng.uniform(-2, 1)
    radius = 0.1
    pin = {"type": "revolute", "body_i": "ground", "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]}
    at = [radius * (1 + ratio), 0, 0]
    of_wheel = inertia * 10 ** rng.uniform(-1, 1)
    m = model([body("p", 1, [0, 0, 0], inertia=[inertia] * 3), body("w", 1, at, inertia=[of_wheel] * 3)],
              [dict(pin, body_j="p"), dict(pin, body_j="w", s_bar_p_i=at),
               {"type": "gear", "name": "mesh", "body_i": "p", "body_j": "w", "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1],
                "radius_i": radius, "radius_j": radius * ratio}],
              [{"type": "torque", "name": "T", "body": "p", "frame": "global", "components": [0, 0, 1]}])
    rate = 1 / (inertia + of_wheel / ratio ** 2)
    end = math.sqrt(2 * rng.uniform(1, 300) * 2 * math.pi / rate)
    rtol, options = adaptive(rng)
    omega = rate * end

    def error(row):
        theta = 0.5 * rate * end ** 2
        of_both = [(row["p.A11"], row["p.A21"], theta), (row["w.A11"], row["w.A21"], -theta / ratio)]
        turned = max(math.hypot(c - math.cos(a), s - math.sin(a)) for c, s, a in of_both)
        return max(turned, abs(row["p.wz"] - omega) / (1 + omega))

    return m, end, options, error, 3000 * rtol * (1 + 0.5 * rate * end ** 2 * max(1, 1 / ratio))


def kink(rng):
    first, second, at = rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(0.2, 0.8)
    length, mass = 10 ** rng.uniform(-1, 0.5), 10 ** rng.uniform(-1, 1)
    text = f"if({at!r}-t, {first!r}*t, {second!r}*t+{(first - second) * at!r})"
    m = model([body("b", 1, [0, 0, 0], r_dot=[first, 0, 0]),
               {"name": "bob", "mass": mass, "inertia": [1e-9 * mass * length ** 2] * 3, "r": [0, -length, 0], "r_dot": [first, 0, 0]}],
              [RAIL, {"type": "CD", "name": "move", "body_i": "ground", "body_j": "b", "c": [1, 0, 0], "f": text},
               {"type": "revolute", "name": "pin", "body_i": "b", "body_j": "bob", "s_bar_q_j": [0, length, 0],
                "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]}])
    # The impulse of the kink leaves the bob with its velocity: it turns with a constant rate about the cart.
    rate = (first - second) / length
    rtol, options = adaptive(rng)
    end = at + min(1, 2 / (abs(rate) + 1e-3))
    angle = rate * (end - at)
    x = first * at + second * (end - at)
    return (m, end, options, lambda row: max(abs(row["b.rx"] - x), abs(row["bob.rx"] - x - length * math.sin(angle)),
                                             abs(row["bob.ry"] + length * math.cos(angle))),
            3000 * rtol * (1 + abs(x) + length + abs(rate)))


def event(rng):
    z, g = 10 ** rng.uniform(-1, 1), 9.81
    text = rng.choice(["b.rz^3", "b.rz*exp(-10*b.rz)", "1e6*b.rz", "1e-9*b.rz", "tanh(1e3*b.rz)", "if(b.rz, 1, -1)", "b.rz^5",
                       "b.rz/(1e-3+abs(b.rz))"])
    t = math.sqrt(2 * z / g)
    end = t * rng.uniform(1.05, 4)
    integrator = rng.choice(ADAPTIVE[:3] + ["rA-half-2", "rA-half-1-momentum"])
    options = ["--integrator", integrator]
    if integrator in ADAPTIVE:
        options += ["--rtol", "1e-10"]
    else:
        options += ["--step", f"{end / rng.randint(50, 400)!r}"]
    m = model([body("b", 1, [0, 0, z])], gravity=[0, 0, -g], events=[{"name": "zero", "value": text, "action": "stop"}])
    return m, end, options, lambda row: abs(row["t"] - t), 1e-8 * (1 + t)


def branch(rng):
    r, l = 1, rng.uniform(1.1, 4)
    rate, angle = 10 ** rng.uniform(0, 3.3), rng.uniform(0, 6.28)
    b = math.asin(r / l * math.sin(angle))
    pin = {"type": "revolute", "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]}
    x = r * math.cos(angle) + l * math.cos(b)
    turned = {"axis_angle": [0, 0, 1, angle]}
    m = model([body("b", 1, [x, 0, 0]), body("c", 1, [r / 2 * math.cos(angle), r / 2 * math.sin(angle), 0], **turned),
               body("k", 1, [r * math.cos(angle) + l / 2 * math.cos(b), r / 2 * math.sin(angle), 0], axis_angle=[0, 0, 1, -b])],
              [RAIL, dict(pin, body_i="ground", body_j="c", s_bar_q_j=[-r / 2, 0, 0], name="A"),
               dict(pin, body_i="c", body_j="k", s_bar_p_i=[r / 2, 0, 0], s_bar_q_j=[-l / 2, 0, 0], name="B"),
               dict(pin, body_i="k", body_j="b", s_bar_p_i=[l / 2, 0, 0], name="C"),
               {"type": "hinge-driver", "name": "d", "body_i": "ground", "body_j": "c", "axis_bar_i": [0, 0, 1],
                "axis_bar_j": [0, 0, 1], "angle": f"{angle!r}+{rate!r}*t"}])
    end = rng.uniform(0.5, 1)

    def error(row):
        a = angle + rate * row["t"]
        return abs(row["b.rx"] - r * math.cos(a) - math.sqrt(l * l - (r * math.sin(a)) ** 2))

    return m, end, ["kinematics", "--interval", f"{end / rng.randint(2, 20)!r}", "--fix-initial"], error, 1e-7 * (1 + rate * 1e-4)


def hold(rng):
    mass, R, part = 10 ** rng.uniform(-3, 3), 10 ** rng.uniform(-2, 1), rng.uniform(0.5, 0.99)
    rolls = rng.random() < 0.5
    compliant = rng.random() < 0.5
    law = rng.choice(["slide-roll-spin", "epsd"] if compliant else ["slide-roll-spin", "implicit"])
    theta = math.atan(part * (0.2 if rolls else 0.5))
    weight = 9.81 * mass
    K = weight / R * 10 ** rng.uniform(2.5, 5)
    friction = {"law": law, "mu_s": 0.5, "mu_k": 0.2, "K_E": K}
    friction.update(({"mu_r": 0.2} if law == "epsd" else {"eta_r": 0.2}) if rolls else {})
    normal = {"type": "hooke", "stiffness": K, "restitution": 0.5} if compliant else {"type": "constraint"}
    z = R - (weight * math.cos(theta) / K if compliant else 0)
    fixed = [{"type": "DP1", "body_i": "ground", "body_j": "b", "a_bar_i": a, "a_bar_j": c}
             for a, c in (([1, 0, 0], [0, 0, 1]), ([1, 0, 0], [0, 1, 0]), ([0, 1, 0], [0, 0, 1]))]
    I = 0.4 * mass * R * R
    m = model([body("b", mass, [0, 0, z], inertia=[I] * 3)], [] if rolls else fixed,
              gravity=[9.81 * math.sin(theta), 0, -9.81 * math.cos(theta)],
              contacts=[{"name": "c", "body_i": "b", "body_j": "ground", "surface_i": {"type": "sphere", "radius": R},
                         "surface_j": {"type": "plane"}, "normal": normal, "friction": friction}])
    step = 0.07 * math.sqrt(mass / K)
    scheme = rng.choice(["rA-half-1", "rA-half-1-kick", "rA-half-1-momentum"])
    return (m, 2000 * step, ["--integrator", scheme, "--step", f"{step:.3g}"], lambda row: abs(row["b.rx"]),
            0.05 * weight * math.sin(theta) / K)


def crossing(rng):
    R, speed = 10 ** rng.uniform(-2, 0), 10 ** rng.uniform(1, 3)
    step = R / speed * 10 ** rng.uniform(-1, 1.3)
    offset = 1.8 * R * rng.random()
    distance = R * rng.uniform(3, 60)
    compliant = rng.random() < 0.5
    mass = 1
    normal = ({"type": "hooke", "stiffness": mass * (0.5 * speed / R) ** 2, "restitution": 0.8} if compliant else
              {"type": "constraint", "unilateral": True, "restitution": 1})
    I = 0.4 * mass * R * R
    ball = {"type": "sphere", "radius": R}
    m = model([body("a", mass, [0, offset, 0], inertia=[I] * 3, r_dot=[speed, 0, 0]), body("b", mass, [distance, 0, 0], inertia=[I] * 3)],
              contacts=[{"name": "c", "body_i": "a", "body_j": "b", "surface_i": ball, "surface_j": ball, "normal": normal}])
    end = (distance + 30 * R) / speed
    options = ["--integrator", "rA-half-1-kick", "--step", f"{step!r}"] + (["--accept-step"] if compliant else [])
    return m, end, options, lambda row: 0 if math.hypot(row["b.vx"], row["b.vy"]) > 1e-3 * speed else 1, 0.5


KINDS = {"stop": stop, "pulse": pulse, "gear": gear, "kink": kink, "event": event, "branch": branch, "hold": hold, "pass": crossing}


def last_row(file):
    with open(file, encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    return [{key: float(value) for key, value in row.items() if key and value not in ("", None)} for row in (rows[-1],)][0]


def main():
    row = matrix.Row("24 edges of step control")
    with matrix.scratch() as folder:
        for kind, make in KINDS.items():
            answers = 0
            for seed in range(SEEDS):
                rng = random.Random(f"{kind}{seed}")
                m, end, options, error, limit = make(rng)
                (folder / "m.json").write_text(json.dumps(m))
                command = "run"
                if options[0] == "kinematics":
                    command, options = options[0], options[1:]
                if "--interval" not in options:
                    options = options + ["--interval", f"{end!r}"]
                ended = row.run([row.hilda, command, "m.json", "--end", f"{end!r}", *options, "--output", "out", "--force", "--quiet"], cwd=folder)
                what = f"{kind} {seed} {' '.join(options)}"
                if ended.code in (0, 4):
                    answers += ended.code == 0
                    if ended.code == 4:
                        row.case(what, matrix.is_one_line(ended.err) or "error[" in ended.err, ended.err)
                        continue
                    found = error(last_row(folder / "out/trajectory.csv"))
                    row.case(what, found <= limit, f"error {found:.3g}, limit {limit:.3g}")
                elif ended.code == 2 and "stability limit" in ended.err:
                    row.case(what, True)
                else:
                    row.case(what, False, f"exit code {ended.code}: {ended.last_error()}")
            least = 0.5 if kind == "pass" else 0.9
            row.case(f"{kind}: answers", answers >= least * SEEDS, f"{answers} of {SEEDS} runs gave an answer")
    row.end()


main()
