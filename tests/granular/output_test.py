#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The columns of run.csv: loads of all boundaries, and the motion of those that move.

    output_test.py PROGRAM
"""
import csv
import math
import sys
import tempfile

from case_runs import Runs, expect


def rows_of(runs, output):
    with open(runs.folder / output / "run.csv", encoding="utf-8") as table:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(table)]


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        # a cup with a shaken floor, a turning wall and a free lid; no particles touch the lid
        runs.finish(runs.case("cup", end=5e-3, interval=1e-3), "--quiet", "--output", "cup")
        rows = rows_of(runs, "cup")
        expect(len(rows) == 6, f"rows: {len(rows)}")
        for row in rows:
            t = row["t"]
            for name, value in (("floor_x", 0), ("floor_z", 1e-4 * math.sin(2 * math.pi * 40 * t)),
                                ("wall_x", 0.01), ("wall_vz", 0)):
                expect(abs(row[name] - value) <= 1e-8 * abs(value) + 1e-18, f"{name} at {t} s: {row[name]}")
            # F = m g + 0.1 t on the lid of 2e-3 kg, first order in the step of 5e-6 s
            speed = -9.81 * t - 0.1 * t * t / 2 / 2e-3
            fall = -9.81 * t * t / 2 - 0.1 * t**3 / 6 / 2e-3
            expect(abs(row["lid_vz"] - speed) < 1e-4 and abs(row["lid_z"] - 0.04 - fall) < 1e-6,
                   f"the lid at {t} s: {row}")
            expect(row["lid_vx"] == row["lid_wz"] == 0, f"the lid moves along z only: {row}")
        expect(abs(rows[-1]["wall_wz"] - 5 * 5e-3) < 5e-5, f"the wall turns with 5 t: {rows[-1]}")

        floor = {"name": "floor", "type": "plane", "normal": [0, 0, 1], "material": "steel"}
        still = runs.case("still", boundaries=[floor], end=1e-4, interval=5e-5)
        runs.finish(still, "--quiet", "--output", "still")
        names = list(rows_of(runs, "still")[0])
        expect(names[-1] == "floor_Tz" and "floor_z" not in names, f"a boundary at rest has no motion: {names}")
    print("run.csv has the motion of moving boundaries")


if __name__ == "__main__":
    main()
