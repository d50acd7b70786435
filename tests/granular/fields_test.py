#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse-grained fields of a case: their files, integrals and notices, the number of threads, and a later end.

    fields_test.py PROGRAM
"""
import csv
import math
import re
import sys
import tempfile

from case_runs import CASE, Runs, expect

BOX = {"low": [-0.002, -0.002, -0.002], "high": [0.022, 0.022, 0.042], "cells": [6, 1, 11], "width": 1.2e-3}
FIELDS = [dict(BOX, name="box", edges="closed", interval=4e-3),
          dict(BOX, name="mean", low=[-0.006, -0.006, -0.006], high=[0.026, 0.026, 0.05], kernel="lucy", width=2.5e-3,
               interval=4e-3, samples=4),
          dict(BOX, name="points", values="points", cells=[2, 2, 2], interval=8e-3)]


def rows_of(runs, output, file):
    with open(runs.folder / output / file, encoding="utf-8") as table:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(table)]


def volume(field):
    return math.prod((high - low) / cells for low, high, cells in zip(field["low"], field["high"], field["cells"]))


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        case = runs.case("cup", fields=FIELDS, end=0.024, interval=4e-3, frame_interval=0.012)
        err = runs.finish(case, "--output", "one", "--end", "0.024")
        expect("/fields" not in err, f"there is no notice: {err}")
        particles = rows_of(runs, "one", "particles.csv")
        mass = sum(2500 * 4 / 3 * math.pi * p["radius"] ** 3 for p in particles)
        momentum = sum(2500 * 4 / 3 * math.pi * p["radius"] ** 3 * p["vz"] for p in particles)
        files = runs.summary("one")["files"]
        for field, outputs in zip(FIELDS, (7, 6, 4)):
            rows, cells = rows_of(runs, "one", f"fields-{field['name']}.csv"), math.prod(field["cells"])
            expect(len(rows) == outputs * cells, f"{field['name']}: {len(rows)} rows")
            expect({f"fields-{field['name']}.csv", f"fields-{field['name']}.pvd"} <= set(files), f"summary.json: {files}")
            frames = len(list((runs.folder / "one" / "vtk").glob(f"fields-{field['name']}-*.vti")))
            listed = (runs.folder / "one" / f"fields-{field['name']}.pvd").read_text().count(".vti")
            expect(frames == listed == outputs, f"{field['name']}: {frames} frames, {listed} in the list")
            if field["name"] == "points":
                continue
            for k in range(0, len(rows), cells):
                total = volume(field) * sum(row["density"] for row in rows[k:k + cells])
                # the masses of the program are in single precision
                expect(abs(total / mass - 1) < 1e-7, f"{field['name']}: mass {total} of {mass}")
            last = volume(field) * sum(row["momentum_z"] for row in rows[-cells:])
            if field["name"] == "box":
                expect(abs(last / momentum - 1) < 1e-6, f"{field['name']}: momentum {last} of {momentum}")
            sums = {name: volume(field) * sum(row["contact_stress_" + name] for row in rows[-cells:]) for name in ("xx", "zz", "xz")}
            whole, size = rows_of(runs, "one", "run.csv")[-1], math.prod(h - l for l, h in zip(*CASE["domain"].values()))
            for name, value in sums.items():
                if field["name"] == "box":  # of one instant; the whole branches are in the grid
                    expect(abs(value - whole["stress_" + name] * size) < 1e-6 * abs(sums["zz"]), f"stress {name}: {value} {whole}")
            row = max(rows[-cells:], key=lambda one: one["density"])
            expect(abs(row["velocity_z"] * row["density"] - row["momentum_z"]) < 1e-9, f"velocity: {row}")

        whole = runs.sha("one")
        runs.finish(case, "--output", "three", "--threads", "3", "--end", "0.024")
        expect(runs.sha("three") == whole, "the number of threads does not change the files")
        # the first leg ends between two samples of a mean, the second one is later than the last output
        for leg in (("--end", "0.0095"), ("--end", "0.0225", "--resume"), ("--end", "0.024", "--resume")):
            runs.finish(case, "--output", "legs", *leg)
        expect(runs.sha("legs") == whole, "a run to later ends writes the same files")

        again = runs.case("again", fields=[dict(FIELDS[0], name="other")], end=1e-3)
        runs.finish(again, "--output", "one", "--force", "--no-vtk")
        left = sorted(path.name for path in (runs.folder / "one").glob("fields-*"))
        expect(left == ["fields-other.csv", "fields-other.pvd"], f"a new run removes the files of an earlier one: {left}")
        expect(not list((runs.folder / "one" / "vtk").glob("fields-mean-*")), "and its frames")

        for kernel, width, than in (("gaussian", 5e-4, "radius"), ("lucy", 1.5e-3, "diameter")):
            narrow = runs.case("narrow", fields=[dict(BOX, kernel=kernel, width=width, interval=1e-3)], end=1e-3)
            err = runs.finish(narrow, "--output", "narrow", "--force")
            expect(re.search(rf"narrow.json:1:\d+ \(/fields/0/width\): a width of \S+ m is below the {than} of the largest "
                             rf"particle, 0.00[12] m", err), f"notice: {err}")
    print("the fields of the case have mass, momentum and stress of the particles")


if __name__ == "__main__":
    main()
