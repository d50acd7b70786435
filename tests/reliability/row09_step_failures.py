#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 9: 20 models whose steps fail by design end with the stated status within 10 s, and never silently."""
import json

import matrix
import model as models

FALL = {"hilda_model": 1, "name": "fall", "end": 1, "bodies": [{"name": "bar", "mass": 1, "inertia": [1, 1, 1], "r": [1, 0, 0]}]}


def with_constraints(*constraints, **changes):
    return {**FALL, "constraints": list(constraints), **changes}


def pin(**changes):
    return {"name": "pin", "type": "spherical", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [-1, 0, 0], **changes}


def revolute(name="hinge", **changes):
    return {"name": name, "type": "revolute", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [-1, 0, 0], "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0], **changes}


def driver(angle, name="turn"):
    return {"name": name, "type": "hinge-driver", "body_i": "ground", "body_j": "bar", "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0], "angle": angle}


def force(component):
    return {"name": "push", "type": "force", "body": "bar", "point_bar": [0, 0, 0], "frame": "global", "components": [0, 0, component]}


def cases():
    """What, model, step [s], exit codes, text of the message (any of the alternatives)"""
    step = 1e-3
    rod = {"name": "rod", "type": "D", "body_i": "ground", "body_j": "bar"}
    yield "redundant constraints are dropped and named", with_constraints(revolute(), pin()), step, (0,), ("redundant",)
    yield "two equal hinges", with_constraints(revolute(), revolute("again")), step, (0,), ("redundant",)
    yield "contradictory constraint", with_constraints(pin(), {**rod, "f": "4"}), step, (3,), ("violate",)
    yield "inconsistent position", with_constraints(pin(s_bar_q_j=[-0.5, 0, 0])), step, (3,), ("violate",)
    yield "inconsistent velocity", with_constraints(pin(), bodies=[{**FALL["bodies"][0], "r_dot": [1, 0, 0]}]), step, (3,), ("violate",)
    yield "two drivers of one hinge that differ", with_constraints(revolute(), driver("0"), driver("t^2", "other")), step, (3, 4), ("turn", "other")
    yield "driver that contradicts a lock", with_constraints(revolute(), {"name": "lock", "type": "DP1", "body_i": "ground", "body_j": "bar",
                                                                         "a_bar_i": [1, 0, 0], "a_bar_j": [0, 0, 1]}, driver("t^2")), step, (3, 4), ("turn", "lock")
    yield "rod that must be longer than it can", with_constraints(pin(), {**rod, "f": "1 + t"}, gravity=[0, 0, 0]), step, (3, 4), ("rod", "pin")
    yield "rod whose length becomes imaginary", with_constraints({**rod, "f": "1 - 30*t"}, gravity=[0, 0, 0]), step, (3, 4), ("rod",)
    yield "DP1 beyond 1", with_constraints(pin(), {"name": "angle", "type": "DP1", "body_i": "ground", "body_j": "bar", "a_bar_i": [0, 0, 1], "a_bar_j": [1, 0, 0],
                                                 "f": "20*t"}, gravity=[0, 0, 0]), step, (3, 4), ("angle",)
    yield "driver with a jump", with_constraints(revolute(), driver("3*step(t-0.05)")), step, (4,), ("turn", "hinge", "rotates")
    yield "driver that is too fast", with_constraints(revolute(), driver("50000*t^2")), step, (3, 4), ("rotates", "turn")
    yield "force that becomes NaN", {**FALL, "forces": [force("sqrt(0.05-t)")]}, step, (4,), ("push",)
    yield "force that overflows", {**FALL, "forces": [force("exp(1e5*(t-0.05))")]}, step, (4,), ("bar",)
    yield "spin beyond half a turn per step", {**FALL, "bodies": [{**FALL["bodies"][0], "omega": [0, 0, 4000]}]}, step, (4,), ("rotates",)
    yield "step far too large", models.valid(), 0.5, (2, 3, 4), ("step", "stability")
    yield "stiff spring", models.changed("/forces/0/stiffness", 1e12), step, (2, 3, 4), ("spring", "rotates", "converge", "iterations")
    deep = models.changed("/bodies/2/r", [9, 0, 0.02])
    yield "deep initial overlap", deep, step, (3,), ("overlap",)
    yield "body that lies on the axis of its rod", with_constraints({**rod, "f": "0"}, bodies=[{**FALL["bodies"][0], "r": [0, 0, 0]}]), step, (3, 4), ("rod",)
    edge = models.changed("/contacts/0/surface_i", {"type": "height-map", "heights": [[0] * 4] * 4, "spacing": [1, 1]})
    yield "ball beyond the edge of its surface", edge, step, (3, 4), ("floor",)


def main():
    row = matrix.Row("9 step failures")
    with matrix.scratch() as folder:
        for what, model, step, codes, words in cases():
            (folder / "m.json").write_text(json.dumps(model))
            row.run(["rm", "-rf", "out"], cwd=folder)
            ended = row.run([row.hilda, "run", "m.json", "--step", step, "--end", 0.2, "--output", "out", *(["--force"] if step < 0.1 else [])], cwd=folder, limit=60)
            said = ended.err + ended.out if 0 in codes else ended.err
            row.case(what, ended.code in codes and ended.seconds < 10 and any(word in said for word in words), f"exit {ended.code}: {said}")
    row.end()


main()
