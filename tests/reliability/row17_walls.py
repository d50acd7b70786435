#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 17: equal walls give equal rebounds, and the order of the particles does not matter.

A ball rebounds from a plane and from the side of a box with the same velocity (1e-9 relative), for 10 normals and
speeds.

108 particles fly to the centre of a cloud, in 10 orders. Until a particle has two contacts at once their states are
equal to the last digit. Afterwards the sum of its loads depends on the order: the particles are sorted by (cell, id),
two particles of one cell exchange their places, and the sum in single precision is rounded differently. Collisions
amplify this like any other difference. The difference of two orders at the end must not be larger than that of the
smallest possible change of the initial positions, one unit of their integer coordinates: the largest of 10 such runs.
"""
import csv
import json
import math
import random

import matrix

BASE = {"hilda_case": 1, "step": 1e-6, "end": 4e-3, "gravity": [0, 0, 0],
        "domain": {"low": [-0.05, -0.05, -0.05], "high": [0.05, 0.05, 0.05]},
        "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
        "laws": [{"restitution": 0.7, "mu": 0.3, "tangential": {"law": "mindlin"}}]}
UNIT = 5e-12  # of a coordinate: the width of a cell over 2^29, rounded upwards [m]
BEFORE_SUMS, AFTER_SUMS = 3e-4, 2e-3  # ends of the runs: before and after a particle has two contacts at once [s]
VELOCITIES = ("vx", "vy", "vz", "omega_x", "omega_y", "omega_z")


def particles(folder):
    with open(folder / "particles.csv") as table:
        return list(csv.DictReader(table))


def imploding(rng):
    """108 particles on a lattice that fly to its centre. Their radii differ: they identify the particles."""
    cloud = []
    for i in range(6):
        for j in range(6):
            for k in range(3):
                r = [0.0025 * (i - 2.5), 0.0025 * (j - 2.5), 0.0025 * (k - 1)]
                cloud.append({"r": r, "radius": round(1e-3 * rng.uniform(0.8, 1.2), 7),
                              "v": [round(-100 * x + rng.uniform(-0.3, 0.3), 6) for x in r], "material": "glass"})
    return cloud


def moved(cloud, rng):
    """The cloud with each coordinate changed by UNIT"""
    return [{**one, "r": [x + rng.choice((-UNIT, UNIT)) for x in one["r"]]} for one in cloud]


def states(rows):
    """The rows of the particles in the order of their radii"""
    if not isinstance(rows, list):
        return rows
    return sorted([float(one["radius"])] + [float(one[name]) for name in one if name not in ("id", "material")]
                  for one in rows)


def difference(states, others):
    """The largest difference of two states over the largest value of its column"""
    if not isinstance(states, list) or not isinstance(others, list) or len(states) != len(others):
        return math.inf
    sizes = [max(abs(one[column]) for one in states) or 1 for column in range(len(states[0]))]
    return max(abs(a - b) / size for one, other in zip(states, others) for a, b, size in zip(one, other, sizes))


def main():
    row = matrix.Row("17 walls and permutations")
    rng = random.Random(1)
    with matrix.scratch() as folder:
        def run(case):
            row.run(["rm", "-rf", "out"], cwd=folder)
            (folder / "case.json").write_text(json.dumps(case))
            ended = row.run([row.granular, "case.json", "--quiet", "--output", "out"], cwd=folder, limit=300)
            return particles(folder / "out") if ended.code == 0 else ended.err
        for k in range(10):
            axis, sign = k % 3, 1 if k % 2 else -1
            speed = 0.2 + 0.1 * k
            normal, r, v = [0, 0, 0], [0, 0, 0], [0.05 * (k + 1), 0.03 * k, -0.02 * k]
            normal[axis], r[axis], v[axis] = -sign, sign * 0.0385, sign * speed
            wall = [0, 0, 0]
            wall[axis] = sign * 0.04
            ball = {"particles": [{"r": r, "radius": 1e-3, "v": v, "omega": [3, -2, 1], "material": "glass"}]}
            plane = {"name": "wall", "type": "plane", "normal": normal, "r": wall}
            box = {"name": "box", "type": "box", "low": [-0.04] * 3, "high": [0.04] * 3}
            plane, box = (run({**BASE, **ball, "boundaries": [boundary]}) for boundary in (plane, box))
            passed, why = isinstance(plane, list) and isinstance(box, list), f"{plane} {box}"
            if passed:
                a, b = ([float(one[0][name]) for name in VELOCITIES] for one in (plane, box))
                why = f"{a} {b}"
                passed = math.dist(a, b) <= 1e-9 * math.hypot(*a) and -sign * a[axis] > 0.3 * speed
            row.case(f"wall {k}", passed, why)
        cloud = imploding(rng)
        exact, found = (states(run({**BASE, "end": end, "particles": cloud})) for end in (BEFORE_SUMS, AFTER_SUMS))
        disturbed = [states(run({**BASE, "end": AFTER_SUMS, "particles": moved(cloud, rng)})) for _ in range(10)]
        growth = max(difference(found, other) for other in disturbed)
        for k in range(10):
            rng.shuffle(cloud)
            same = difference(exact, states(run({**BASE, "end": BEFORE_SUMS, "particles": cloud})))
            worst = difference(found, states(run({**BASE, "end": AFTER_SUMS, "particles": cloud})))
            row.case(f"permutation {k}", same == 0 and 0 < growth < 1 and worst <= growth,
                     f"differs by {same:.1e} before and by {worst:.1e} after the first particle with two contacts, "
                     f"where moved particles differ by {growth:.1e}, of the largest values")
    row.end()


main()
