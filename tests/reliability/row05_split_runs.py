#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 5: a run that is continued every tenth step writes the same tables as an uninterrupted run: 7 integrators, and
grains."""
import json

import matrix

FIXED, ADAPTIVE = ["--step", 1e-3], ["--rtol", 1e-8]
INTEGRATORS = {"rA-half-1": FIXED, "rA-half-1-momentum": FIXED, "rA-full-1": FIXED, "rA-rattle": FIXED, "rA-rkmk-4": FIXED,
               "rA-dp-5": ADAPTIVE, "rA-dop853": ADAPTIVE, "rA-radau-5": ADAPTIVE}
STEPS, PART = 200, 10


def equal(folder, parts, whole, table):
    """True if both runs have the same tables, and the one of the name `table` is among them"""
    expected = matrix.tables(folder / whole)
    return table in expected and matrix.tables(folder / parts) == expected


def main():
    row = matrix.Row("5 split runs")
    with matrix.scratch() as folder:
        for model in ("double_pendulum", "ball_in_bowl"):
            for integrator, steps in INTEGRATORS.items():
                if model == "ball_in_bowl" and integrator in ("rA-full-1-exact", "rA-radau-5"):
                    continue
                if model == "ball_in_bowl":  # adaptive steps do not support contacts
                    steps = FIXED
                command = [row.hilda, "run", model, "--integrator", integrator, *steps, "--interval", 2e-3,
                           "--quiet"]
                row.run(command + ["--end", STEPS * 1e-3, "--output", "whole", "--force"], cwd=folder)
                codes = []
                for k in range(PART, STEPS + 1, PART):
                    part = ["--end", f"{k * 1e-3:.3f}", "--output", "parts", "--force" if k == PART else "--resume"]
                    codes.append(row.run(command + part, cwd=folder).code)
                same = equal(folder, "parts", "whole", "trajectory.csv")
                a, b = (json.loads((folder / name / "summary.json").read_text()) for name in ("whole", "parts"))
                equal_sums = a["counters"] == b["counters"] and a["invariants"] == b["invariants"]
                row.case(f"{model} {integrator}", same and set(codes) == {0} and equal_sums,
                         f"codes {codes}, tables {same}, {a['counters']}, {b['counters']}")
        case = json.loads((matrix.SOURCE / "granular/cases/bed.json").read_text())
        case["fill"][0]["high"] = [0.03, 0.02, 0.01]
        interval = 50 * case["step"]
        case.update(interval=interval, frame_interval=4 * interval)
        (folder / "bed.json").write_text(json.dumps(case))
        command = [row.granular, "bed.json", "--quiet", "--contacts", "--interval", interval]
        parts = 12
        row.run(command + ["--end", repr(parts * interval), "--output", "grains", "--force"], cwd=folder)
        codes = []
        for k in range(1, parts + 1):
            part = ["--end", repr(k * interval), "--output", "grain-parts", "--force" if k == 1 else "--resume"]
            codes.append(row.run(command + part, cwd=folder).code)
        same = equal(folder, "grain-parts", "grains", "run.csv")
        row.case("grains", same and set(codes) == {0}, f"codes {codes}, tables {same}")
    row.end()


main()
