#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory of a run is little more than the arrays of its world, and the check before a run asks for as much.

    memory_test.py PROGRAM
"""
import math
import os
import re
import subprocess
import sys
import tempfile

from case_runs import CASE, Runs, expect

SIDE = 45  # particles along an edge of each of the two lattices
RADIUS = 1e-3


def peak(runs, name):
    """Largest memory of a run [bytes]"""
    process = subprocess.Popen([runs.program, f"{name}.json", "--quiet", "--output", name], cwd=runs.folder)
    _, status, usage = os.wait4(process.pid, 0)
    expect(status == 0, f"{name} ends with 0, not {status}")
    return 1024 * usage.ru_maxrss


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        spacing = 2 * RADIUS * 2 / math.sqrt(3)

        def case(name, edge, fill):
            runs.case(name, fill=fill, orientation=False, end=1e-4, interval=5e-5, frame_interval=1e-4,
                      domain={"low": [-RADIUS] * 3, "high": [edge + RADIUS] * 3},
                      boundaries=[{"name": "box", "type": "box", "low": [0] * 3, "high": [edge] * 3}],
                      materials=CASE["materials"][:1], laws=CASE["laws"][:1])

        # Two lattices of touching particles, which together are body-centred: four pairs for a particle
        edge = (SIDE + 0.5) * spacing
        lattices = [{"type": "lattice", "low": [low] * 3, "high": [low + SIDE * spacing] * 3, "radius": RADIUS,
                     "spacing": spacing / (2 * RADIUS), "random_v": 1} for low in (0, spacing / 2)]
        case("lattice", edge, lattices)
        case("table", edge, [{"type": "csv", "file": "lattice/particles.csv"}])
        case("one", edge, [dict(lattices[0], count=1)])
        case("large", 1e5, [{"type": "lattice", "low": [0] * 3, "high": [1e5] * 3, "radius": RADIUS, "count": 10**12}])
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
            own = (used - program) / count
            of_world = runs.summary(name)["provenance"]["bytes_per_particle"]
            print(f"{name}: {count} particles, {of_world:.0f} bytes each, {asked:.0f} asked for, {own:.0f} used, "
                  f"{used / count:.0f} with the program")
            expect(count == 2 * SIDE**3, f"number of particles: {count}")
            expect(used < 700 * count, f"{name}: {used / count} bytes per particle")
            expect(0.9 < asked / of_world < 1.1, f"{name}: {asked} bytes are asked for, a particle has {of_world}")
            expect(own < 1.1 * of_world, f"{name}: {own} bytes are used, a particle has {of_world}")


if __name__ == "__main__":
    main()
