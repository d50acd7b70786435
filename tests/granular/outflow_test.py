#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases whose particles leave the domain: outflow.csv, the columns of run.csv, and what is refused.

Usage: outflow_test.py PROGRAM
"""
import csv
import json
import math
import sys
import tempfile

from case_runs import ATTACHED, CASE, Runs, expect

# The cup without floor and lid: the grains fall out of the domain.
DOMAIN = dict(CASE["domain"], outflow=["-z"])
OPEN = dict(domain=DOMAIN, boundaries=[CASE["boundaries"][1]], frame_interval=7e-3, interval=4e-3,
            particles=ATTACHED["particles"][1:], fill=ATTACHED["fill"])


def rows(runs, output, name):
    with open(runs.folder / output / name, encoding="utf-8") as table:
        return list(csv.DictReader(table))


def main():
    runs = Runs(sys.argv[1], tempfile.mkdtemp())
    case = runs.case("open", **OPEN)
    runs.finish(case, "--end", "0.1", "--output", "whole")
    left, run = rows(runs, "whole", "outflow.csv"), rows(runs, "whole", "run.csv")
    particles = rows(runs, "whole", "particles.csv")
    number = json.loads((runs.folder / "whole" / "summary.json").read_text())
    expect(len(left) > 10 and len({row["id"] for row in left + particles}) == len(left) + len(particles),
           "each particle is in one of the two tables")
    expect([row["id"] for row in particles][:2] == ["0", "1"] and
           abs(math.hypot(float(particles[1]["x"]) - 0.01, float(particles[1]["y"]) - 0.01) - 4e-3) < 1e-12,
           "the particles attached to the wall remain, at their distance from its axis")
    expect(all(row["side"] == "-z" and -0.0025 < float(row["z"]) <= -0.002 and float(row["vz"]) < 0 for row in left),
           "the particles leave downwards, and are found close to the side")
    times = [float(row["t"]) for row in left]
    expect(times == sorted(times), "the table is ordered by time")
    for row in run:
        of = [p for p in left if float(p["t"]) < float(row["t"]) - 1e-9]
        mass = sum(float(p["mass"]) for p in of)
        expect(int(row["removed"]) == len(of) and abs(float(row["removed_mass"]) - mass) <= 1e-7 * mass,
               f"run.csv has the number and the mass at {row['t']} s")
    expect(number["outflow"]["particles"] == len(left) and "outflow.csv" in number["files"], "so has summary.json")

    # The table does not depend on the number of threads, nor on an interruption between its rows.
    runs.finish(case, "--end", "0.1", "--output", "threads", "--threads", "3")
    expect(runs.sha("threads") == runs.sha("whole"), "three threads write the same files")
    for first in ("0.0533", "0.06"):
        runs.finish(case, "--end", first, "--output", "cut")
        runs.finish(case, "--end", "0.1", "--output", "cut", "--resume")
        expect(runs.sha("cut") == runs.sha("whole"), f"a run continued from {first} s writes the same files")
        runs.remove("cut")

    # Without outflow the run ends; with lost = delete it goes on.
    closed = runs.case("closed", **dict(OPEN, domain=CASE["domain"]))
    expect("has left the domain" in runs.finish(closed, "--end", "0.1", "--output", "closed", code=4), "default")
    deleting = runs.case("deleting", **dict(OPEN, domain=dict(CASE["domain"], lost="delete")))
    runs.finish(deleting, "--end", "0.1", "--output", "deleting")
    expect((runs.folder / "deleting" / "outflow.csv").read_bytes() == (runs.folder / "whole" / "outflow.csv").read_bytes(),
           "the same particles are deleted")
    for domain, message in ((dict(DOMAIN, outflow=["-z", "-z"]), r"/domain/outflow/1.*each once, got \"-z\""),
                            (dict(DOMAIN, outflow=["up"]), r"/domain/outflow/0.*got \"up\""),
                            (dict(DOMAIN, outflow=["+x"], periodic=[True, False, False]),
                             r"/domain/outflow.*periodic axis, got \"\+x\""),
                            (dict(DOMAIN, lost="keep"), r"/domain/lost.*error, delete")):
        runs.refused(runs.case("refused", **dict(OPEN, domain=domain)), 3, message)
    print("particles leave the domain, and are recorded")


main()
