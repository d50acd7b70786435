# SPDX-License-Identifier: GPL-3.0-or-later
"""The Atwood machine of a joint and a force that one file adds: closed form, schema and rejected input.

    atwood_test.py PROGRAM
"""

import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

program, here = sys.argv[1], pathlib.Path(__file__).resolve().parent
faults = []


def check(passed, text):
    if not passed:
        faults.append(text)


with tempfile.TemporaryDirectory() as folder:
    out = pathlib.Path(folder) / "out"
    subprocess.run([program, "run", here / "atwood.json", "--integrator", "rA-rkmk-4", "--step", "1e-3", "--quiet",
                    "--no-plot", "--output", out], check=True)
    with open(out / "trajectory.csv", encoding="utf-8") as file:
        last = list(csv.DictReader(file))[-1]
    # (m_1 + m_2) v' = (m_1 - m_2) g - 2 c v
    t, rate, speed = 0.5, 2 * 0.75 / 3, 9.81 / (2 * 0.75)
    z = -2 - speed * (t - (1 - math.exp(-rate * t)) / rate)
    check(abs(float(last["heavy.rz"]) - z) < 1e-9, f"z of the heavy body is {last['heavy.rz']}, must be {z}")

    wrong = json.loads((here / "atwood.json").read_text(encoding="utf-8"))
    wrong["constraints"][0]["length"] = -4
    path = pathlib.Path(folder) / "wrong.json"
    path.write_text(json.dumps(wrong), encoding="utf-8")
    ended = subprocess.run([program, "check", path], capture_output=True, text=True, check=False)
    check(ended.returncode == 3 and "(/constraints/0/length)" in ended.stderr, f"wrong length: {ended.stderr}")

schema = json.loads(subprocess.run([program, "schema"], capture_output=True, check=True).stdout)
for kind, name in (("constraint", "rope"), ("force", "drag")):
    check({"$ref": f"#/$defs/{name}"} in schema["$defs"][f"any_{kind}"]["oneOf"], f"{name} is not in the schema")

print("\n".join(faults) or "closed form, rejected input and schema: passed")
sys.exit(1 if faults else 0)
