#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs with granular laws of their own: physics, lists, schema, checkpoints, and the bytes of hilda-granular.

    law_test.py HILDA_GRANULAR FOLDER      FOLDER: written by hilda new granular-law two-slopes, built
"""

import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import jsonschema

original, law = sys.argv[1], pathlib.Path(sys.argv[2])
mine, two = law / "build/two-slopes-granular", law / "build/with-two"
case = json.loads((law / "head_on.json").read_text(encoding="utf-8"))
faults = []


def check(passed, text):
    if not passed:
        faults.append(text)


def call(program, *arguments, code=0):
    ended = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    check(ended.returncode == code, f"{program} {arguments}: exit {ended.returncode}, expected {code}\n{ended.stderr}")
    return ended.stdout if code == 0 else ended.stderr


def rows(file):
    with open(file, encoding="utf-8") as text:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(text)]


with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)

    # Closed forms of a collision at several velocities: the relative velocity after it is e times that before, its duration is
    # pi/2 (1 + 1/e) sqrt(m*/k).
    m_eff = 2500 * 4 / 3 * math.pi * 0.01**3 / 2
    for v, e, k in ((1, 0.6, 1e4), (0.1, 0.3, 1e4), (2, 0.9, 4e4)):
        out = folder / f"head_on-{v}"
        call(mine, law / "head_on.json", "--quiet", "--no-vtk", "--output", out, "--end", 0.002 / v + 0.02,
             "--set", f"/laws/0/restitution={e}", "--set", f"/laws/0/normal/k={k}",
             "--set", f"/particles/0/v=[{v},0,0]", "--set", f"/particles/1/v=[{-v},0,0]")
        after = [row["vx"] for row in rows(out / "particles.csv")]
        check(abs(after[0] + e * v) < 2e-5 * v and abs(after[1] - e * v) < 2e-5 * v, f"v = {v}, e = {e}: {after} m/s")
        duration = 1e-5 * sum(row["contacts"] > 0 for row in rows(out / "run.csv"))
        closed = math.pi / 2 * (1 + 1 / e) * math.sqrt(m_eff / k)
        check(abs(duration - closed) < 2.5e-5, f"v = {v}, e = {e}: {duration} s, closed form {closed} s")

    # lists, schema, version, summary
    check("normal      two-slopes" in call(mine, "laws") and "two-slopes" not in call(original, "laws"), "the list of laws")
    check("cohesion    per-radius" in call(two, "laws") and "cohesion    sjkr" in call(two, "laws"), "the list of two laws")
    check("added laws: normal two-slopes" in call(mine, "--version"), "the version names the added law")
    summary = json.loads((folder / "head_on-1/summary.json").read_text(encoding="utf-8"))
    check(summary["provenance"]["added_laws"] == "normal two-slopes", "the summary names the added law")
    schema = json.loads(call(mine, "schema"))
    jsonschema.validate(case, schema)
    wrong = json.loads(json.dumps(case))
    wrong["laws"][0]["normal"]["k"] = -1
    check(not jsonschema.Draft202012Validator(schema).is_valid(wrong), "the schema has the keys of the law")

    # messages
    (folder / "wrong.json").write_text(json.dumps(wrong), encoding="utf-8")
    check("(/laws/0/normal/k): k must be positive, got -1" in call(mine, folder / "wrong.json", code=3), "a wrong key")
    check('unknown law "two-slopes"; allowed: hertz, hooke, hunt-crossley, kuwabara-kono, scaled-hooke' in
          call(original, law / "head_on.json", "--output", folder / "no", code=3), "the law is unknown to hilda-granular")
    check("step must not be above" in call(mine, law / "head_on.json", "--step", 1e-2, "--output", folder / "no", code=3),
          "the limit of the time step follows from the collision time of the law")

    # Checkpoints: a run that is continued within the collision has the bytes of one that is not.
    intervals = ("--set", "/frame_interval=1e-4", "--quiet", "--contacts")
    call(mine, law / "head_on.json", "--end", 0.0015, *intervals, "--output", folder / "cut")
    call(mine, law / "head_on.json", "--end", 0.003, *intervals, "--output", folder / "cut", "--resume")
    call(mine, law / "head_on.json", "--end", 0.003, *intervals, "--output", folder / "whole")
    for name in ("run.csv", "particles.csv", "contacts.csv", "checkpoint.end"):
        check((folder / "cut" / name).read_bytes() == (folder / "whole" / name).read_bytes(), f"checkpoint: {name}")

    # An attraction of f R* between two spheres at rest with Hooke's law: the overlap oscillates about f R*/k_n.
    cohesive = json.loads(json.dumps(case))
    cohesive.update(end=0.05, step=2e-6)
    cohesive["laws"] = [{"normal": {"law": "hooke", "k_n": 1e3, "gamma_n": 800}, "cohesion": {"law": "per-radius", "f": 2}}]
    for x, particle in zip((-1, 1), cohesive["particles"]):
        particle.update(r=[x * (0.01 - 1e-6), 0, 0], v=[0, 0, 0])
    (folder / "cohesive.json").write_text(json.dumps(cohesive), encoding="utf-8")
    call(two, folder / "cohesive.json", "--quiet", "--no-vtk", "--output", folder / "cohesive")
    x = [row["x"] for row in rows(folder / "cohesive/particles.csv")]
    check(abs(0.02 - (x[1] - x[0]) - 2 * 0.005 / 1e3) < 1e-8, f"cohesion: overlap {0.02 - (x[1] - x[0])} m, expected 1e-5 m")

    # The bytes of hilda-granular for a case with all kinds of built-in laws
    bed = {"hilda_case": 1, "name": "cup", "domain": {"low": [-2e-3, -2e-3, -2e-3], "high": [0.022, 0.022, 0.08]},
           "step": 5e-6, "end": 0.02, "interval": 1e-3, "orientation": True,
           "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
           "laws": [{"restitution": 0.7, "mu": 0.3, "tangential": {"law": "mindlin"}, "cohesion": {"law": "sjkr", "k": 10},
                     "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}, "spin": {"law": "torsional-spring"}}],
           "boundaries": [{"name": "floor", "type": "plane", "normal": [0, 0, 1], "r": [0, 0, 0]},
                          {"name": "wall", "type": "cylinder", "r": [0.01, 0.01, 0], "axis": [0, 0, 1], "radius": 0.01, "inside": True}],
           "fill": [{"type": "lattice", "low": [3e-3, 3e-3, 0], "high": [0.017, 0.017, 0.02], "radius": 1e-3, "random_v": 0.2}]}
    (folder / "bed.json").write_text(json.dumps(bed), encoding="utf-8")
    for program, name in ((original, "original"), (mine, "mine"), (two, "two")):
        call(program, folder / "bed.json", "--quiet", "--output", folder / name)
    files = [file.relative_to(folder / "original") for file in (folder / "original").rglob("*") if file.is_file()]
    check(len(files) > 40, f"{len(files)} files")
    for name in ("mine", "two"):
        for file in files:
            if file.name != "summary.json":
                check((folder / name / file).read_bytes() == (folder / "original" / file).read_bytes(), f"{name}: {file} differs")

for fault in faults:
    print(fault)
sys.exit(1 if faults else 0)
