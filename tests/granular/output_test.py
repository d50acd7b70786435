#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The columns of run.csv, loads of all boundaries and the motion of those that move, and the rows of replicas.

    output_test.py PROGRAM
"""
import csv
import math
import sys
import tempfile

from case_runs import CASE, Runs, expect


def rows_of(runs, output, file="run.csv"):
    with open(runs.folder / output / file, encoding="utf-8") as table:
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

        # three replicas: the rows of each, and their sums
        fills = [dict(CASE["fill"][0], replica=k, seed=k, low=[0.003, 0.003, 0.002 * k]) for k in (0, 1, 2)]
        three = runs.case("three", boundaries=[floor, CASE["boundaries"][1]], fill=fills, end=0.06, interval=0.015)
        runs.finish(three, "--quiet", "--output", "three", "--replica-rows")
        whole = rows_of(runs, "three")
        parts = rows_of(runs, "three", "replicas.csv")
        expect(len(parts) == 3 * len(whole) and [row["replica"] for row in parts[:4]] == [0, 1, 2, 0], "rows of replicas")
        particles = (runs.folder / "three" / "particles.csv").read_text().count("\n") - 1
        for k, row in enumerate(whole):
            mine = parts[3 * k:3 * k + 3]
            expect(sum(one["particles"] for one in mine) == particles, f"numbers of particles: {mine}")
            expect(all(one["t"] == row["t"] for one in mine), f"times: {mine}")
            for name in ("kinetic_energy", "contacts", *(f"{b}_{c}{a}" for b in ("floor", "wall") for c in "FT" for a in "xyz")):
                total, size = sum(one[name] for one in mine), sum(abs(one[name]) for one in mine)
                expect(abs(total - row[name]) <= 1e-8 * size, f"{name} at {row['t']} s: {total} and {row[name]}")
        expect(len({row["kinetic_energy"] for row in parts[3:6]}) == 3 and parts[-1]["contacts"] > 50, f"{parts[3:6]} {parts[-1]}")
        expect("replicas.csv" in runs.summary("three")["files"], "summary.json lists the file")
        alone = runs.case("alone", boundaries=[floor, CASE["boundaries"][1]], fill=[dict(fills[1], replica=0)],
                          end=0.06, interval=0.015)
        runs.finish(alone, "--quiet", "--output", "alone", "--replica-rows")
        first = rows_of(runs, "alone", "replicas.csv")[0]
        expect(dict(first, replica=1) == parts[1], f"a replica alone: {first} {parts[1]}")
    print("run.csv has the motion of moving boundaries")


if __name__ == "__main__":
    main()
