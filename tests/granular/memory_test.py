#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory of a run is little more than the arrays of its world, and the check before a run asks for as much.

    memory_test.py PROGRAM
"""
import os
import re
import subprocess
import sys
import tempfile

from case_runs import CASE, Runs, expect

SIDE = 50  # particles along an edge


def peak(runs, name):
    """Largest memory of a run [bytes]"""
    process = subprocess.Popen([runs.program, f"{name}.json", "--quiet", "--output", name], cwd=runs.folder)
    _, status, usage = os.wait4(process.pid, 0)
    expect(status == 0, f"{name} ends with 0, not {status}")
    return 1024 * usage.ru_maxrss


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        width = SIDE * 2.1e-3
        settings = {"orientation": False, "domain": {"low": [-0.002] * 3, "high": [width + 0.002] * 3}, "end": 1e-4, "interval": 5e-5,
                    "frame_interval": 1e-4, "boundaries": [{"name": "box", "type": "box", "low": [0] * 3, "high": [width] * 3}],
                    "materials": CASE["materials"][:1], "laws": CASE["laws"][:1]}
        lattice = {"type": "lattice", "low": [0] * 3, "high": [width] * 3, "radius": 1e-3, "spacing": 1.05, "jitter": 1, "random_v": 0.1}
        runs.case("lattice", fill=[lattice], **settings)
        runs.case("table", fill=[{"type": "csv", "file": "lattice/particles.csv"}], **settings)
        runs.case("large", fill=[dict(lattice, high=[1e5 * width] * 3, count=10**12)],
                  **dict(settings, domain={"low": [-0.002] * 3, "high": [1e5 * width] * 3}))
        runs.case("one", fill=[dict(lattice, count=1)], **settings)
        refused = runs.run("large.json", "--output", "large")
        err = refused.stderr
        expect(refused.returncode == 3, f"the case is too large: {refused.returncode}")
        found = re.search(r"\(/fill\): 1e\+12 particles need about (\S+) GB of memory; ", err)
        expect(found is not None, f"the check: {err}")
        asked = float(found.group(1)) / 1000  # for a particle [bytes]
        program = peak(runs, "one")
        for name in ("lattice", "table"):
            used = peak(runs, name)
            count = runs.summary(name)["case"]["particles"]
            of_world = runs.summary(name)["provenance"]["bytes_per_particle"]
            print(f"{name}: {count} particles, {(used - program) / count:.0f} bytes each, {of_world:.0f} in the world, {asked:.0f} asked for")
            expect(count == SIDE**3, f"number of particles: {count}")
            expect(used < 700 * count, f"{name}: {used / count} bytes per particle")
            own = (used - program) / count
            expect(0.9 < asked / own < 1.35, f"{name}: {asked} bytes are asked for, {own} are used")


if __name__ == "__main__":
    main()
