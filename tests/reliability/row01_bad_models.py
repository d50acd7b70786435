#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 1: 210 bad model files end with exit code 3 and one line with the place, within 1 s and 256 MB."""
import json
import re

import matrix
import model as models

KEYS = [f"/bodies/{b}/{key}" for b in range(3) for key in ("name", "mass", "inertia", "r")] + \
       [f"/constraints/{c}/{key}" for c in range(2) for key in ("name", "type", "body_i", "body_j", "s_bar_q_j")] + \
       ["/forces/0/stiffness", "/forces/0/free_length", "/forces/0/s_bar_p_i",
        "/forces/1/components", "/forces/1/frame",
        "/contacts/0/surface_i", "/contacts/0/surface_j/radius", "/contacts/0/normal/E_star",
        "/contacts/0/friction/mu_s",
        "/gravity", "/end", "/hilda_model", "/bodies", "/constraints", "/forces", "/contacts",
        "/constraints/0/axis_bar_i", "/forces/1/body"]


def syntax(text):
    """40 texts that are not JSON"""
    structure = [k for k, c in enumerate(text) if c in "{}[],:"]
    for k in range(20):  # a character of the structure is missing
        at = structure[(k * 37 + 5) % len(structure)]
        yield f"without character {at}", text[:at] + text[at + 1:]
    for k in range(8):  # the end is missing
        yield f"truncated {k}", text[:len(text) * (k + 1) // 10]
    for what in ("NaN", "Infinity", "+1", "01", "1.", ".5", "0x10", "'a'", "True", "1e", "1e400", "\"\\q\""):
        yield f"literal {what}", text.replace('"end": 1', f'"end": {what}', 1)


def types():
    """40 values of a wrong type"""
    for k in range(40):
        pointer = KEYS[k]
        container, key = models.at(models.valid(), pointer)
        value = container[key]
        wrong = {"a": 1} if not isinstance(value, dict) else 7
        if k % 3 == 0:
            wrong = None
        elif k % 3 == 1 and not isinstance(value, bool):
            wrong = True
        yield f"{pointer} = {wrong}", models.changed(pointer, wrong)


def ranges():
    """40 values out of range"""
    for b in range(3):
        for pointer, value in (("mass", 0), ("mass", -1), ("inertia", [1, 1, -1]), ("inertia", [1, 1, 3]),
                               ("inertia", [0, 1, 1]), ("p", [1, 1, 0, 0]), ("r", [1e400, 0, 0]), ("omega", [0, 0])):
            yield f"body {b} {pointer} = {value}", models.changed(f"/bodies/{b}/{pointer}", value)
    for pointer, value in (("/end", -1), ("/gravity", [0, 0]), ("/gravity", [0, 0, 0, 1]),
                           ("/hilda_model", 2), ("/hilda_model", 0),
                           ("/forces/0/stiffness", -1), ("/forces/0/damping", -1), ("/forces/0/free_length", -1),
                           ("/contacts/0/surface_j/radius", 0), ("/contacts/0/surface_j/radius", -0.1),
                           ("/contacts/0/normal/E_star", 0), ("/contacts/0/normal/E_star", -1e6),
                           ("/contacts/0/friction/mu_s", -0.3), ("/contacts/0/friction/K_E", -1),
                           ("/contacts/0/friction/mu_k", 0.4), ("/constraints/0/axis_bar_i", [0, 0, 0])):
        yield f"{pointer} = {value}", models.changed(pointer, value)


def keys():
    """20 unknown and duplicate keys"""
    for pointer in ("/massless", "/bodies/0/mas", "/bodies/1/colour", "/constraints/0/axis", "/constraints/1/stiffness",
                    "/forces/0/k", "/forces/1/force",
                    "/contacts/0/mu", "/contacts/0/surface_j/diameter", "/contacts/0/normal/E"):
        yield f"unknown {pointer}", models.text(models.changed(pointer, 1))
    text = models.text(models.valid())
    for key in ('"mass": 3', '"end": 1', '"name": "bench"', '"name": "bob"', '"type": "revolute"', '"stiffness": 10',
                '"radius": 0.1', '"frame": "global"', '"mu_s": 0.3', '"gravity": [0, 0, -9.81]'):
        yield f"twice {key}", text.replace(key, f"{key}, {key}", 1)


def references():
    """20 names of bodies and of types that are not there"""
    for pointer in ("/constraints/0/body_i", "/constraints/0/body_j", "/constraints/1/body_i", "/constraints/1/body_j",
                    "/forces/0/body_i", "/forces/0/body_j", "/forces/1/body",
                    "/contacts/0/body_i", "/contacts/0/body_j"):
        for value in ("barr", 99):
            yield f"{pointer} = {value}", models.changed(pointer, value)
    yield "a body joined with itself", models.changed("/constraints/0/body_i", "bar")
    yield "two bodies of one name", models.changed("/bodies/1/name", "bar")


def inconsistent():
    """20 initial states that contradict the constraints"""
    for k in range(10):
        yield f"position {k}", models.changed("/bodies/0/r", [1 + 10.0 ** (-k / 2), 0, 0])
    for k in range(10):
        yield f"velocity {k}", models.changed("/bodies/0/r_dot", [10.0 ** (-k / 2), 0, 0])


def paths(folder):
    """20 meshes that are no usable files"""
    (folder / "empty.stl").write_text("")
    (folder / "noise.stl").write_bytes(bytes(range(256)) * 3)
    (folder / "text.obj").write_text("hello\n")
    (folder / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (folder / "nan.obj").write_text("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (folder / "folder.stl").mkdir()
    for path in ("none.stl", "none.obj", "../none.stl", "/none.stl", "empty.stl", "noise.stl", "text.obj", "open.obj",
                 "nan.obj", "folder.stl", "/dev/zero", "/dev/null", "/dev/stdin", "", "bench.json", "a\nb.stl",
                 "a" * 300 + ".stl", "mesh.ply", ".", "/proc/self/mem"):
        yield f"mesh {path!r}", models.changed("/contacts/0/surface_j", {"type": "mesh", "file": path})


def sizes():
    """10 texts beyond the limits"""
    yield "depth 65", '{"a": ' * 65 + "1" + "}" * 65
    yield "depth 10^5", "[" * 100000
    yield "depth 10^5, balanced", "[" * 100000 + "]" * 100000
    yield "long name", models.text(models.changed("/name", "a" * 5000))
    yield "long body name", models.text(models.changed("/bodies/0/name", "a" * 100000))
    yield "integer 2^60", models.text(models.changed("/bodies/0/id", 2 ** 60))
    yield "number of 10^5 digits", models.text(models.valid()).replace('"end": 1', '"end": 1' + "0" * 100000, 1)
    yield "empty", ""
    yield "only blanks", " " * 1000000
    yield "long expression", models.text(models.changed("/forces/1/components", ["+".join(["t"] * 3000), 0, 0]))


def main():
    row = matrix.Row("1 bad model files")
    with matrix.scratch() as folder:
        def check(what, bad):
            (folder / "bad.json").write_text(bad if isinstance(bad, str) else json.dumps(bad))
            ended = row.run([row.hilda, "check", "bad.json"], cwd=folder, stdin=-3)
            why = f"exit {ended.code}, {ended.seconds:.2f} s, {ended.bytes >> 20} MB: {ended.err}"
            has_place = re.match(r"hilda: error: bad\.json(:\d+:\d+ \(/[^ ]*\)|:\d+:\d+)?: .+", ended.err, re.S)
            small = ended.seconds < 1 and ended.bytes < 256 << 20
            row.case(what, ended.code == 3 and matrix.is_one_line(ended.err) and has_place and small, why)

        (folder / "bad.json").write_text(models.text(models.valid()))
        if row.run([row.hilda, "check", "bad.json"], cwd=folder).code != 0:
            raise SystemExit("the unchanged model is refused")
        for kind in (syntax(models.text(models.valid())), types(), ranges(), keys(), references(), inconsistent(),
                     paths(folder), sizes()):
            for what, bad in kind:
                check(what, bad)
    row.end()


main()
