#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases with insertions: the mass flow in run.csv, interruptions, seeds, and insertions without place.

Usage: insertion_test.py PROGRAM
"""
import csv
import json
import math
import sys
import tempfile

from case_runs import CASE, Runs, expect

# The cup without floor and lid, fed from above by a number and by a mass
FEED = [{"name": "feed", "rate": 4000, "to": 0.03, "v": [0, 0, -0.5], "random_v": 0.2, "material": "glass",
         "sizes": {"type": "lognormal", "median": 6e-4, "deviation": 0.2, "by": "mass"},
         "region": {"type": "cylinder", "r": [0.01, 0.01, 0.03], "axis": [0, 0, 1], "radius": 0.009, "length": 0.01}},
        {"mass_rate": 0.02, "radius": 1e-3, "material": "steel", "from": 0.01, "v": [0, 0, -1], "interval": 3e-3,
         "region": {"type": "disk", "r": [0.01, 0.01, 0.05], "normal": [0, 0, 1], "radius": 0.005}}]
LAWS = CASE["laws"] + [dict(CASE["laws"][1], between=["steel", "steel"])]
FED = dict(domain=dict(CASE["domain"], outflow=["-z"]), boundaries=[CASE["boundaries"][1]], frame_interval=7e-3, interval=4e-3,
           laws=LAWS, fill=[], insert=FEED)
END = ("--end", "0.1")


def rows(runs, output, name):
    with open(runs.folder / output / name, encoding="utf-8") as table:
        return list(csv.DictReader(table))


def mass_flow(runs, case):
    """Numbers, masses and their rates in run.csv, and the mass balance"""
    runs.finish(case, *END, "--output", "whole")
    run, particles, left = (rows(runs, "whole", f"{name}.csv") for name in ("run", "particles", "outflow"))
    summary = runs.summary("whole")
    for number, row in enumerate(run):
        inside, put, out = (int(row[name]) for name in ("particles", "inserted", "removed"))
        expect(inside == put - out, f"{inside} particles at {row['t']} s are {put} inserted less {out} removed ones")
        for name in ("inserted_mass", "removed_mass"):
            rate, before = float(row[f"{name}_rate"]), run[number - 1] if number else row
            expected = (float(row[name]) - float(before[name])) / 4e-3
            expect(abs(rate - expected) <= 1e-7 * float(row[name]) / 4e-3, f"{name}_rate at {row['t']} s: {rate}, not {expected}")
    expect(run[0]["particles"] == "0", "the row at 0 is before the first insertion")
    expect(int(run[-1]["removed"]) > 50 and len(particles) + len(left) == int(run[-1]["inserted"]), "all particles are in one table")
    by_name = {entry["name"]: entry for entry in summary["insertions"]}
    expect(by_name["feed"]["particles"] == 120, f"rate times time: {by_name}")
    expect(abs(by_name["insertion 1"]["mass"] / (0.02 * (0.1 - 0.01)) - 1) < 0.05, f"mass rate times time: {by_name}")
    density = (2500, 7800)
    inside = sum(4 / 3 * math.pi * float(p["radius"]) ** 3 * density[int(p["material"])] for p in particles)
    put, out = sum(entry["mass"] for entry in summary["insertions"]), summary["outflow"]["mass"]
    expect(abs(inside + out - put) < 1e-6 * put, f"{put} kg inserted, {inside} kg inside, {out} kg left")
    radii = sorted(float(p["radius"]) for p in particles + left if float(p["radius"]) != 1e-3)
    expect(3e-4 < radii[0] < radii[-1] < 6e-4 * math.exp(0.6) * 1.000001, f"radii from {radii[0]} to {radii[-1]}")


def interruptions(runs, case):
    """Threads, ends within and between rows, and seeds"""
    whole = runs.sha("whole")
    runs.finish(case, *END, "--output", "threads", "--threads", "3")
    expect(runs.sha("threads") == whole, "three threads write the same files")
    for first in ("0.0205", "0.032", "0.0533"):
        runs.finish(case, "--end", first, "--output", "cut", "--threads", "2")
        runs.finish(case, *END, "--output", "cut", "--resume")
        expect(runs.sha("cut") == whole, f"a run continued from {first} s writes the same files")
        runs.remove("cut")
    for seed, same in (("1", False), ("7", False)):
        runs.finish(case, *END, "--output", "seed", "--seed", seed)
        expect((rows(runs, "seed", "particles.csv") == rows(runs, "whole", "particles.csv")) == same, f"the seed {seed}")
        expect([entry["seed"] for entry in json.loads((runs.folder / "seed" / "case.json").read_text())["insert"]] ==
               [int(seed), int(seed) + 1], "--seed sets the seeds of the insertions")
        runs.remove("seed")


def clumps(runs):
    """Inserted clumps: mass flow, the mass balance with outflow, and one result for any threads and interruptions"""
    pair = {"name": "pair", "material": "glass", "spheres": [{"radius": 6e-4}, {"r": [8e-4, 0, 0], "radius": 5e-4}]}
    feed = [dict(entry, clump="pair") for entry in FEED]
    feed[0]["sizes"] = {"type": "uniform", "least_radius": 7e-4, "largest_radius": 1e-3}
    for entry in feed:
        del entry["material"]
    case = runs.case("clumps", **dict(FED, clumps=[pair], insert=feed))
    runs.finish(case, *END, "--output", "clumps")
    clumps, particles, left = (rows(runs, "clumps", f"{name}.csv") for name in ("clumps", "particles", "outflow"))
    summary, last = runs.summary("clumps"), rows(runs, "clumps", "run.csv")[-1]
    by_name = {entry["name"]: entry for entry in summary["insertions"]}
    expect(by_name["feed"]["particles"] == 120, f"rate times time in clumps: {by_name}")
    expect(abs(by_name["insertion 1"]["mass"] / (0.02 * (0.1 - 0.01)) - 1) < 0.05, f"mass rate times time: {by_name}")
    expect(2 * len(clumps) == len(particles) and len(left) > 50, f"{len(clumps)} clumps of {len(particles)} spheres, {len(left)} have left")
    expect(len(particles) + len(left) == 2 * int(last["inserted"]), f"all spheres are in one table: {last}")
    inside, put = sum(float(c["mass"]) for c in clumps), sum(entry["mass"] for entry in by_name.values())
    expect(abs(inside + summary["outflow"]["mass"] - put) < 1e-6 * put, f"{put} kg inserted, {inside} kg inside")
    whole = runs.sha("clumps")
    runs.finish(case, *END, "--output", "other", "--threads", "3")
    expect(runs.sha("other") == whole, "three threads write the same files")
    runs.remove("other")
    for first in ("0.0205", "0.0533"):
        runs.finish(case, "--end", first, "--output", "cut", "--threads", "2")
        runs.finish(case, *END, "--output", "cut", "--resume")
        expect(runs.sha("cut") == whole, f"a run with clumps continued from {first} s writes the same files")
        runs.remove("cut")


def blocked(runs):
    """An insertion without place ends with 4, with its region; the last state is kept"""
    box = {"type": "box", "low": [0.006, 0.006, 0.01], "high": [0.012, 0.012, 0.014]}
    small = dict(FED, gravity=[0, 0, 0], insert=[{"count": 60, "radius": 1e-3, "material": "glass", "region": box, "interval": 1e-3,
                                                  "tries": 2000}])
    message = (r"\[insertion_blocked\]: insertion 'insertion 0': no place for a particle of radius 0.001 m in its region, a box "
               r"from \(0.006, 0.006, 0.01\) to \(0.012, 0.012, 0.014\), in ")
    case = runs.case("blocked", **small)
    runs.refused(case, 4, message + r"20\d\d tries from t = \S+ s to t = 0.0\d+ s; it has inserted \d+ particles", "--output", "blocked")
    placed = len(rows(runs, "blocked", "particles.csv"))
    expect(4 < placed < 20, f"{placed} particles have found a place")
    expect(runs.summary("blocked")["status"] == "insertion_blocked", "the status")
    before = (runs.folder / "blocked" / "particles.csv").read_bytes()
    runs.refused(case, 4, message, "--output", "blocked", "--resume")
    expect((runs.folder / "blocked" / "particles.csv").read_bytes() == before, "the resumed run ends in the same state")
    small["insert"][0]["on_overlap"] = "refuse"
    runs.refused(runs.case("refusing", **small), 4, message + r"\d+ tries from t = 0 s to t = 0 s; it has inserted \d+ particles",
                 "--output", "refusing")
    # a law is missing for the inserted material
    runs.refused(runs.case("lawless", **dict(FED, laws=CASE["laws"])), 3, "no law is set between two materials that can be in contact",
                 "--output", "lawless")
    # the step is compared with the particles that will come
    runs.refused(runs.case("coarse", **dict(FED, step=1e-4)), 3, "/step.*the stability limit", "--output", "coarse")


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        case = runs.case("fed", **FED)
        mass_flow(runs, case)
        interruptions(runs, case)
        clumps(runs)
        blocked(runs)
    print("particles are inserted, and their mass is balanced")


main()
