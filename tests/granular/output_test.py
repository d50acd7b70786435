#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The columns of run.csv, loads of all boundaries and the motion of those that move, the rows of replicas, mean loads and
lists of contacts.

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


def check_means_and_lists(runs):
    """Mean loads are those of rows at the same instants, and lists of contacts give the loads on boundaries."""
    loads, contacts = {"interval": 0.01, "samples": 10}, {"interval": 0.02, "times": [0.0215, 0.003], "network": True}
    case = runs.case("means", end=0.025, interval=1e-3, frame_interval=5e-3, loads=loads, contacts=contacts)
    runs.finish(case, "--quiet", "--output", "means")
    rows, means = rows_of(runs, "means"), rows_of(runs, "means", "loads.csv")
    expect([row["t"] for row in means] == [0.01, 0.02], f"times of the means: {means}")
    for k, mean in enumerate(means):
        of = rows[1 + 10 * k:11 + 10 * k]
        for name in (f"{b}_{c}{a}" for b in ("floor", "wall", "lid") for c in "FT" for a in "xyz"):
            values = [row[name] for row in of]
            average = sum(values) / 10
            deviation = math.sqrt(sum((v - average) ** 2 for v in values) / 10)
            size = 1e-8 * max(map(abs, values)) + 1e-20
            expect(abs(mean[name + "_mean"] - average) <= size and abs(mean[name + "_std"] - deviation) <= size,
                   f"{name} at {mean['t']} s: {mean[name + '_mean']}, {mean[name + '_std']}; {average}, {deviation}")
    expect(any(row["floor_Fz_std"] > 0 for row in means), f"the loads fluctuate: {means}")

    lists = rows_of(runs, "means", "contact-lists.csv")
    by_time = {}
    for contact in lists:
        by_time.setdefault(contact["t"], []).append(contact)
    expect(sorted(by_time) == [0.003, 0.02, 0.0215], f"times of the lists: {sorted(by_time)}")  # none touch at t = 0
    row = next(row for row in rows if row["t"] == 0.02)
    expect(len(by_time[0.02]) == row["contacts"], f"{len(by_time[0.02])} contacts, {row['contacts']} in run.csv")
    force = [0, 0, 0]
    for c in by_time[0.02]:
        n, t = ([c[name + a] for a in "xyz"] for name in ("n", "Ft"))
        expect(abs(sum(x * y for x, y in zip(n, t))) < 1e-7 * max(map(abs, t), default=0) + 1e-15, f"normal and tangential: {c}")
        if c["boundary"] == 1 and c["j"] == 0:
            force = [f - c["Fn"] * x - y for f, x, y in zip(force, n, t)]
            expect(abs(c["z"] - row["floor_z"]) < 1e-9, f"the contact point is on the floor: {c}")
    for a, f in zip("xyz", force):
        expect(abs(f - row["floor_F" + a]) < 1e-7 * abs(row["floor_Fz"]), f"force on the floor: {force}, {row}")
    frames = sorted(path.name for path in (runs.folder / "means" / "vtk").glob("contacts-*"))
    expect(frames == [f"contacts-{k:06}.vtp" for k in range(6)], f"frames: {frames}")
    text = (runs.folder / "means" / "vtk" / "contacts-000004.vtp").read_bytes()
    expect(b'NumberOfLines="%d"' % row["contacts"] in text and b'Name="normal force"' in text, f"network: {text[:400]}")
    expect((runs.folder / "means" / "run.pvd").read_text().count("vtk/contacts-") == 6, "run.pvd lists the networks")
    expect({"loads.csv", "contact-lists.csv"} <= set(runs.summary("means")["files"]), "summary.json lists the files")
    runs.finish(case, "--quiet", "--output", "means", "--force", "--set", "/contacts={\"times\": [0.003]}")
    expect(not list((runs.folder / "means" / "vtk").glob("contacts-*")), "a new run removes the networks of an earlier one")


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

        particles, last = rows_of(runs, "cup", "particles.csv"), rows[-1]
        masses = [2500 * 4 / 3 * math.pi * p["radius"] ** 3 for p in particles]
        turning = sum(0.2 * m * p["radius"] ** 2 * sum(p["omega_" + a] ** 2 for a in "xyz") for m, p in zip(masses, particles))
        moving = sum(0.5 * m * sum(p["v" + a] ** 2 for a in "xyz") for m, p in zip(masses, particles))
        height = sum(9.81 * m * p["z"] for m, p in zip(masses, particles))
        expect(last["particles"] == len(particles), f"number of particles: {last}")
        # masses are in single precision
        for name, value in (("rotational_energy", turning), ("kinetic_energy", turning + moving), ("potential_energy", height),
                            *(("momentum_" + a, sum(m * p["v" + a] for m, p in zip(masses, particles))) for a in "xyz")):
            expect(abs(last[name] - value) < 1e-6 * sum(masses), f"{name}: {last[name]}, {value}")

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
            for name in ("kinetic_energy", "contacts", "particles", *("momentum_" + a for a in "xyz"), *(f"{b}_{c}{a}" for b in ("floor", "wall") for c in "FT" for a in "xyz")):
                total, size = sum(one[name] for one in mine), sum(abs(one[name]) for one in mine)
                expect(abs(total - row[name]) <= 1e-8 * size, f"{name} at {row['t']} s: {total} and {row[name]}")
        expect(len({row["kinetic_energy"] for row in parts[3:6]}) == 3 and parts[-1]["contacts"] > 50, f"{parts[3:6]} {parts[-1]}")
        expect("replicas.csv" in runs.summary("three")["files"], "summary.json lists the file")
        alone = runs.case("alone", boundaries=[floor, CASE["boundaries"][1]], fill=[dict(fills[1], replica=0)],
                          end=0.06, interval=0.015)
        runs.finish(alone, "--quiet", "--output", "alone", "--replica-rows")
        first = rows_of(runs, "alone", "replicas.csv")[0]
        expect(dict(first, replica=1) == parts[1], f"a replica alone: {first} {parts[1]}")
        check_means_and_lists(runs)
    print("run.csv has the motion of moving boundaries")


if __name__ == "__main__":
    main()
