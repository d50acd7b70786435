#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 9: 20 models whose steps fail by design end with the stated status within 10 s, and never silently."""
import json

import matrix
import model as models

BAR = {"name": "bar", "mass": 1, "inertia": [1, 1, 1], "r": [1, 0, 0]}
FALL = {"hilda_model": 1, "name": "fall", "end": 1, "bodies": [BAR]}
AXES = {"axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]}
ROD = {"name": "rod", "type": "D", "body_i": "ground", "body_j": "bar"}
FREE = {"gravity": [0, 0, 0]}


def with_constraints(*constraints, **changes):
    return {**FALL, "constraints": list(constraints), **changes}


def pin(**changes):
    return {"name": "pin", "type": "spherical", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [-1, 0, 0], **changes}


def revolute(name="hinge", **changes):
    return {"name": name, "type": "revolute", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [-1, 0, 0], **AXES,
            **changes}


def driver(angle, name="turn"):
    return {"name": name, "type": "hinge-driver", "body_i": "ground", "body_j": "bar", **AXES, "angle": angle}


def angle(name, a_bar_i, a_bar_j, **changes):
    return {"name": name, "type": "DP1", "body_i": "ground", "body_j": "bar", "a_bar_i": a_bar_i, "a_bar_j": a_bar_j,
            **changes}


def force(component):
    return {"name": "push", "type": "force", "body": "bar", "point_bar": [0, 0, 0],
            "frame": "global", "components": [0, 0, component]}


def bar(**changes):
    return [{**BAR, **changes}]


def cases():
    """What, model, step [s], exit codes, text of the message (any of the alternatives)"""
    step = 1e-3
    model = with_constraints(revolute(), pin())
    yield "redundant constraints are dropped and named", model, step, (0,), ("redundant",)
    model = with_constraints(revolute(), revolute("again"))
    yield "two equal hinges", model, step, (0,), ("redundant",)
    model = with_constraints(pin(), {**ROD, "f": "4"})
    yield "contradictory constraint", model, step, (3,), ("violate",)
    model = with_constraints(pin(s_bar_q_j=[-0.5, 0, 0]))
    yield "inconsistent position", model, step, (3,), ("violate",)
    model = with_constraints(pin(), bodies=bar(r_dot=[1, 0, 0]))
    yield "inconsistent velocity", model, step, (3,), ("violate",)
    model = with_constraints(revolute(), driver("0"), driver("t^2", "other"))
    yield "two drivers of one hinge that differ", model, step, (3, 4), ("turn", "other")
    model = with_constraints(revolute(), angle("lock", [1, 0, 0], [0, 0, 1]), driver("t^2"))
    yield "driver that contradicts a lock", model, step, (3, 4), ("turn", "lock")
    model = with_constraints(pin(), {**ROD, "f": "1 + t"}, **FREE)
    yield "rod that must be longer than it can", model, step, (3, 4), ("rod", "pin")
    model = with_constraints({**ROD, "f": "1 - 30*t"}, **FREE)
    yield "rod whose length becomes imaginary", model, step, (3, 4), ("rod",)
    model = with_constraints(pin(), angle("angle", [0, 0, 1], [1, 0, 0], f="20*t"), **FREE)
    yield "DP1 beyond 1", model, step, (3, 4), ("angle",)
    model = with_constraints(revolute(), driver("3*step(t-0.05)"))
    yield "driver with a jump", model, step, (4,), ("turn", "hinge", "rotates")
    model = with_constraints(revolute(), driver("50000*t^2"))
    yield "driver that is too fast", model, step, (3, 4), ("rotates", "turn")
    yield "force that becomes NaN", {**FALL, "forces": [force("sqrt(0.05-t)")]}, step, (4,), ("push",)
    yield "force that overflows", {**FALL, "forces": [force("exp(1e5*(t-0.05))")]}, step, (4,), ("bar",)
    model = {**FALL, "bodies": bar(omega=[0, 0, 4000])}
    yield "spin beyond half a turn per step", model, step, (4,), ("rotates",)
    yield "step far too large", models.valid(), 0.5, (2, 3, 4), ("step", "stability")
    model = models.changed("/forces/0/stiffness", 1e12)
    yield "stiff spring", model, step, (2, 3, 4), ("spring", "rotates", "converge", "iterations")
    model = models.changed("/bodies/2/r", [9, 0, 0.02])
    yield "deep initial overlap", model, step, (3,), ("overlap",)
    model = with_constraints({**ROD, "f": "0"}, bodies=bar(r=[0, 0, 0]))
    yield "body that lies on the axis of its rod", model, step, (3, 4), ("rod",)
    edge = {"type": "height-map", "heights": [[0] * 4] * 4, "spacing": [1, 1]}
    model = models.changed("/contacts/0/surface_i", edge)
    yield "ball beyond the edge of its surface", model, step, (3, 4), ("floor",)


def main():
    row = matrix.Row("9 step failures")
    with matrix.scratch() as folder:
        for what, model, step, codes, words in cases():
            (folder / "m.json").write_text(json.dumps(model))
            row.run(["rm", "-rf", "out"], cwd=folder)
            ended = row.run([row.hilda, "run", "m.json", "--step", step, "--end", 0.2, "--output", "out",
                             *(["--force"] if step < 0.1 else [])], cwd=folder, limit=60)
            said = ended.err + ended.out if 0 in codes else ended.err
            named = any(word in said for word in words)
            row.case(what, ended.code in codes and ended.seconds < 10 and named, f"exit {ended.code}: {said}")
    row.end()


main()
