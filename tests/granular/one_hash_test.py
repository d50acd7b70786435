#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two cases that combine most features have one SHA-256 each, for any threads, vector instructions, interruptions, rows and
checkpoints.

    one_hash_test.py PROGRAM
"""
import csv
import hashlib
import json
import os
import re
import signal
import sys
import tempfile
import time

from case_runs import Runs, expect

MATERIALS = [{"name": "glass", "density": 2500, "E": 8e6, "nu": 0.24}, {"name": "rubber", "density": 1200, "E": 6e6, "nu": 0.4},
             {"name": "steel", "density": 7800, "E": 1e7, "nu": 0.3}]
LAWS = [{"between": ["glass", "glass"], "restitution": 0.7, "mu": 0.3, "mu_s": 0.4, "tangential": {"law": "mindlin", "rescale": True},
         "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}, "spin": {"law": "torsional-spring"}},
        {"between": ["glass", "rubber"], "restitution": 0.5, "mu": 0.6, "normal": {"law": "hunt-crossley", "alpha": 0.2},
         "tangential": {"law": "mindlin-deresiewicz"}, "rolling": {"law": "pseudo-force", "mu_r": 0.05, "k_r": 2, "eta_r": 0.3},
         "spin": {"law": "torsional-spring", "critical": True}, "lever": "contact"},
        {"between": ["rubber", "rubber"], "restitution": 0.4, "mu": 0.8, "normal": {"law": "kuwabara-kono", "A": 1e-6},
         "tangential": {"law": "mindlin-incremental"}, "cohesion": {"law": "sjkr", "k": 1e3}},
        {"between": ["glass", "steel"], "mu": 0.3, "normal": {"law": "walton-braun", "k_1": 200, "k_2": 400, "S": 1e5},
         "tangential": {"law": "mindlin", "k_t": 150, "gamma_t": 10}, "rolling": {"law": "constant-torque", "mu_r": 0.05}},
        {"between": ["rubber", "steel"], "mu": 0.5, "normal": {"law": "scaled-hooke", "k_n": 800, "gamma_n": 1e3},
         "tangential": {"law": "coulomb", "k_t": 150, "gamma_t": 1e3}, "cohesion": {"law": "constant", "F_c": 1e-6}},
        {"between": ["steel", "steel"], "restitution": 0.6, "normal": {"law": "hertz", "clamped": True}}]
STEP, STEPS = 3e-6, 400
GRAINS = {"type": "lattice", "radius": 2e-4, "least_radius": 1.9e-4, "spacing": 1.0, "random_v": 0.3}
# outputs with lists of contacts, and means over instants between those of the rows
OUTPUTS = {"contacts": {"interval": STEP * 170, "times": [STEP * 33], "network": True}, "loads": {"interval": STEP * 70, "samples": 17},
           "fields": [{"name": "means", "low": [0, 0, 0], "high": [0.0085, 0.008, 0.01], "cells": [5, 4, 3], "width": 1e-3,
                       "interval": STEP * 55, "samples": 6},
                      {"name": "slice", "low": [0, 0, 0], "high": [0.0085, 0.008, 0.01], "cells": [4, 1, 6], "width": 2e-3,
                       "kernel": "lucy", "edges": "closed", "interval": STEP * 130}]}
COMMON = {"step": STEP, "end": STEP * STEPS, "interval": STEP * 30, "frame_interval": STEP * 60, "orientation": True,
          "materials": MATERIALS, "laws": LAWS, **OUTPUTS}

# Small grains, large balls and single particles with a force, fixed and rotating, or attached to a boundary. The grains flow out
# of the domain; a shaken floor, a rotating cylinder, a rotating plate of triangles and a heavy lid move.
DAM = dict(COMMON, gravity=[3, 0, -9.81], domain={"low": [-0.003, -0.003, -0.003], "high": [0.0085, 0.011, 0.016],
                                                  "outflow": ["+x"], "lost": "delete"},
           boundaries=[{"name": "floor", "type": "plane", "normal": [0, 0, 1], "r": [0, 0, "5e-5*sin(2*pi*300*t)"],
                        "material": "steel"},
                       {"name": "back", "type": "plane", "normal": [1, 0, 0], "v": ["0.2*t/0.003", 0, 0], "material": "rubber"},
                       {"name": "sides", "type": "box", "low": [0, 0, 0], "high": [0.008, 0.008, 0.02],
                        "open": ["-x", "+x", "-z", "+z"], "material": "glass"},
                       {"name": "roller", "type": "cylinder", "axis": [0, 1, 0], "r": [0.0043, 0, 0.0084], "radius": 1e-3,
                        "omega": [0, "100*(1+t)", 0], "material": "rubber"},
                       {"name": "lid", "type": "plane", "normal": [0, 0, -1], "r": [0, 0, 0.014], "v": [0, 0, -0.5], "mass": 1e-3,
                        "inertia": [1e-7, 2e-7, 2.5e-7], "F": [0, 0, "-20*t"], "T": [0, "1e-4*t", 0],
                        "free": [False, False, True, True, True, False], "material": "steel"},
                       {"name": "paddle", "type": "mesh", "plate": {"width_x": 0.003, "width_y": 0.005, "edge": 3e-4},
                        "two_sided": True, "rotation": [0, 1.5707963267948966, 0], "r": [0.00815, 0.004, 0.003],
                        "omega": [0, 30, 0], "material": "steel"}],
           particles=[{"r": [0.0005 + 0.0012 * k, 0.0008, 0.0004], "radius": 3e-4, "material": "steel", "attached_to": "floor"}
                      for k in range(4)] +
                     [{"r": [0.0043, 0.001 + 0.002 * k, 0.0074], "radius": 3e-4, "material": "glass", "attached_to": "roller"}
                      for k in range(3)] +
                     [{"r": [0.0072, 0.004, 0.0076], "radius": 5e-4, "material": "rubber", "fixed": True, "omega": [0, 200, 50]},
                      {"r": [0.0072, 0.0015, 0.0078], "radius": 5e-4, "material": "glass", "force": [0, 2e-4, -1e-3]}],
           fill=[dict(GRAINS, low=[0.0002, 0, 0.0008], high=[0.0078, 0.008, 0.0068], material="glass", v=[1.5, 0, 0]),
                 {"type": "lattice", "low": [0, 0, 0.0085], "high": [0.0025, 0.008, 0.011], "radius": 1e-3, "spacing": 1.1,
                  "material": "rubber", "seed": 2},
                 {"type": "lattice", "low": [0.0023, 0.003, 0.0096], "high": [0.0066, 0.0073, 0.0139], "radius": 2e-3,
                  "spacing": 1.05, "count": 1, "material": "rubber", "v": [0, 0, -1]},
                 dict(GRAINS, low=[0, 0.0005, 0.0112], high=[0.002, 0.0075, 0.0122], material="rubber", seed=3)],
           insert=[{"rate": 3e5, "interval": 1.5e-4, "v": [0, 0, -1], "random_v": 0.3, "material": "glass",
                    "sizes": {"type": "lognormal", "median": 2e-4, "deviation": 0.1, "by": "mass"},
                    "region": {"type": "box", "low": [0.0056, 0.0002, 0.009], "high": [0.0078, 0.0028, 0.0135]}}])

# Replicas in a domain that is periodic along x and y, with an integrator that needs the previous accelerations. Grains leave
# upwards.
REPLICAS = dict(COMMON, integrator="chung", gravity=[1, 0.5, -9.81],
                domain={"low": [0, 0, -0.003], "high": [0.0125, 0.0125, 0.012], "periodic": [True, True, False], "outflow": ["+z"]},
                boundaries=[{"name": "floor", "type": "plane", "normal": [0, 0, 1], "r": [0, 0, "0.0032+5e-5*sin(2*pi*300*t)"],
                             "material": "steel"},
                            {"name": "ball", "type": "sphere", "radius": 1e-3, "r": ["0.004+1e-4*sin(2*pi*200*t)", 0.004, 0.0054],
                             "omega": [0, 0, 300], "material": "rubber"},
                            {"name": "post", "type": "cone", "axis": [0, 0, 1], "half_angle": 0.3, "r": [0.009, 0.002, 0.0043],
                             "v": ["0.3", 0, 0], "omega": [0, 0, "2e5*t"], "material": "glass"},
                            {"name": "bump", "type": "mesh", "sphere": {"radius": 8e-4, "divisions": 2}, "r": [0.002, 0.01, 0.0052],
                             "v": [0, 0, "-0.3"], "omega": [200, 0, 0], "material": "rubber"}],
                particles=[{"r": [0.0002, 0.0005 + 0.0018 * k, 0.0046], "radius": 3e-4, "material": "glass", "replica": k,
                            "attached_to": "floor"} for k in range(3)] +
                          [{"r": [0.0065, 0.0065, 0.0064], "radius": 2e-3, "material": "rubber", "replica": k, "v": [0.5, 0, -0.6],
                            "omega": [0, 100, 0]} for k in range(3)],
                fill=[dict(GRAINS, low=[0, 0, 0.0033], high=[0.0125, 0.0125, 0.0042], material=("glass", "rubber")[k % 2], replica=k,
                           seed=k, v=[0.3, 0, 0.3 - 0.3 * k]) for k in range(3)] +
                     [dict(GRAINS, low=[0, 0, 0.0112], high=[0.005, 0.005, 0.012], material="glass", replica=2, v=[0, 0, 0.5])])


def seconds(steps):
    return f"{steps * STEP:.12g}"


def options(last=STEPS):
    return "--replica-rows", "--quiet", "--end", seconds(last)


def table(runs, output, name):
    with open(runs.folder / output / name, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def sha(runs, output):
    """SHA-256 of all output that does not depend on wall time, with the rows of the replicas and the state at the end"""
    out = runs.folder / output
    return hashlib.sha256(runs.sha(output).encode() + (out / "replicas.csv").read_bytes() +
                          (out / "checkpoint.end").read_bytes()).hexdigest()


def instruction_sets(runs):
    """Names of the sets of vector instructions that the program and this processor have"""
    line = re.search("^vector instructions: .*, of (.*)$", runs.run("--version").stdout, re.M)
    return [name for name in line[1].split(", ") if runs.run("laws", "--isa", name).returncode == 0]


def check_content(runs, name):
    """The case has what it is meant to combine"""
    particles, left, rows = (table(runs, "whole", f"{kind}.csv") for kind in ("particles", "outflow", "run"))
    radii = [float(p["radius"]) for p in particles]
    expect(max(radii) > 10 * min(radii), f"{name}: radii from {min(radii)} to {max(radii)}")
    expect(len(particles) + len(left) > 32 * 128, f"{name}: {len(particles) + len(left)} particles are enough for 8 threads")
    expect(len(left) > 50, f"{name}: {len(left)} particles leave the domain")
    expect(max(int(row["contacts"]) for row in rows) > 2000, f"{name}: {[row['contacts'] for row in rows]} contacts")
    materials = {p["id"]: p["material"] for p in particles}
    expect(len(table(runs, "whole", "fields-means.csv")) == 7 * 60 and len(table(runs, "whole", "fields-slice.csv")) == 4 * 24,
           f"{name}: rows of fields")
    expect(len(table(runs, "whole", "loads.csv")) == 5, f"{name}: rows of mean loads")
    times = {row["t"] for row in table(runs, "whole", "contact-lists.csv")}
    expect(len(times) >= 3, f"{name}: lists of contacts at {times}")
    pairs = {tuple(sorted((materials[c["i"]], materials[c["j"]]))) for c in table(runs, "whole", "contacts.csv")
             if c["boundary"] == "0"}
    expect({("0", "0"), ("0", "1")} <= pairs, f"{name}: contacts of the pairs of materials {pairs}")
    on = {c["j"] for c in table(runs, "whole", "contacts.csv") if c["boundary"] == "1"}
    expect(len(on) > 1, f"{name}: contacts with the boundaries {on}")
    return len(particles), len(left), pairs, on


def interrupted(runs, case):
    """The run in legs with different numbers of threads: to ends at several instants, then killed or stopped"""
    for last, threads in ((1, 2), (107, 3), (211, 8), (330, 1), (STEPS, 4)):
        runs.finish(case, *options(last), "--threads", str(threads), "--output", "legs",
                    *(("--resume",) if last > 1 else ()))
    legs = sha(runs, "legs")

    resume = (case, *options(), "--output", "cut", "--checkpoint", "0.005", "--resume")
    resumed = 0
    for which, threads, frame in ((signal.SIGKILL, 3, 1), (signal.SIGINT, 1, 3), (signal.SIGKILL, 8, 4)):
        process = runs.start(*resume, "--threads", str(threads))
        while process.poll() is None and not (runs.folder / "cut" / "vtk" / f"particles-{frame:06}.vtp").exists():
            time.sleep(0.001)
        process.send_signal(which)
        process.communicate()
        expect(process.returncode in (-which, 128 + which), f"signal {which} ends the run, not {process.returncode}")
        resumed += (runs.folder / "cut" / "checkpoint").exists()
    expect(resumed == 3, f"{resumed} of 3 runs have written a checkpoint")
    runs.finish(*resume, "--threads", "2")
    expect(runs.summary("cut")["provenance"]["resumed_at_step"] >= 180, "the last run continues from a checkpoint")
    return {"ends at several instants": legs, "signals": sha(runs, "cut")}


def other_rows(runs, case):
    """Rows, frames and checkpoints at other instants do not change the state"""
    def state(output):
        files = {name: (runs.folder / output / name).read_bytes() for name in ("particles.csv", "contacts.csv", "outflow.csv")}
        summary = runs.summary(output)
        return dict(files, energy=summary["kinetic_energy"], searches=summary["counters"]["rebuilds"])

    whole = state("whole")
    often = ("--interval", seconds(6), "--set", f"/frame_interval={seconds(30)}")
    seldom = ("--interval", seconds(390), "--no-vtk", "--checkpoint", "0.05")
    for name, changes, threads in (("often", often, 3), ("seldom", seldom, 2)):
        runs.finish(case, *options(), *changes, "--threads", str(threads), "--output", name)
        other = state(name)
        expect(other == whole, f"{name}: other rows and frames: {[key for key in whole if whole[key] != other[key]]} differ")
        for file in ("run.csv", "replicas.csv"):
            rows = [table(runs, output, file) for output in ("whole", name)]
            times = set.intersection(*({row["t"] for row in of} for of in rows))
            # the mass flow is that since the row before
            of_both = [[{name: cell for name, cell in row.items() if not name.endswith("_rate")} for row in of if row["t"] in times]
                       for of in rows]
            expect(len(times) >= 2 and of_both[0] == of_both[1], f"{name}: {file}: the rows of {len(times)} instants are equal")
    for k in range(7):
        one, other = (runs.folder / output / "vtk" / f"particles-{frame:06}.vtp" for output, frame in (("whole", k), ("often", 2 * k)))
        expect(one.read_bytes() == other.read_bytes(), f"frame {k} has the same bytes")


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        for name, content in (("dam", DAM), ("replicas", REPLICAS)):
            case = runs.case(name, **content)
            hashes = {}
            for threads in (1, 2, 3, 4, 8):
                output = "whole" if threads == 1 else "threads"
                runs.finish(case, *options(), "--threads", str(threads), "--output", output, "--force")
                hashes[f"{threads} threads"] = sha(runs, output)
            for isa in instruction_sets(runs):
                runs.finish(case, *options(), "--threads", "2", "--isa", isa, "--output", "isa", "--force")
                expect(runs.summary("isa")["provenance"]["vector_instructions"] == isa, f"{name}: --isa {isa} is in the summary")
                hashes[isa] = sha(runs, "isa")
            contents = check_content(runs, name)
            hashes.update(interrupted(runs, case))
            expect(len(set(hashes.values())) == 1, f"{name}: one hash: {hashes}")
            other_rows(runs, case)
            print(f"{name}: {contents}; {hashes.popitem()[1]}")
            for output in ("whole", "threads", "legs", "cut", "often", "seldom"):
                runs.remove(output)
    print(f"CPU time of the runs: {os.times().children_user + os.times().children_system:.1f} s")


if __name__ == "__main__":
    main()
