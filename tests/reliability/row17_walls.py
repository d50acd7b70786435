#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 17: equal walls give equal rebounds, and the order of the particles does not matter.

A ball rebounds from a plane and from the side of a box with the same velocity (1e-9 relative), for 10 normals and
speeds; the states of a cloud of particles agree for 10 orders of its particles, up to rounding of single precision.
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
VELOCITIES = ("vx", "vy", "vz", "omega_x", "omega_y", "omega_z")


def particles(folder):
    with open(folder / "particles.csv") as table:
        return list(csv.DictReader(table))


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
        cloud = [{"r": [0.0025 * i - 0.01, 0.0025 * j - 0.01, 0.0025 * k - 0.01],
                  "radius": round(1e-3 * rng.uniform(0.8, 1.2), 7),
                  "v": [round(rng.uniform(-1, 1), 6) for _ in range(3)], "material": "glass"}
                 for i in range(6) for j in range(6) for k in range(3)]
        first, sizes = None, None
        for k in range(10):
            found = run({**BASE, "end": 1e-3, "particles": cloud})
            if not isinstance(found, list):
                row.case(f"permutation {k}", False, found)
                continue
            names = [name for name in found[0] if name not in ("id", "material")]
            # The radii differ: they identify the particles.
            state = sorted(([float(one["radius"])] + [float(one[name]) for name in names] for one in found))
            if first is None:
                first = state
                sizes = [max(abs(one[column]) for one in state) or 1 for column in range(len(names) + 1)]
            # The sums of contact forces in another order: rounding of single precision, which collisions increase
            worst = max(abs(a - b) / size for one, other in zip(state, first) for a, b, size in zip(one, other, sizes))
            row.case(f"permutation {k}", len(state) == len(first) and worst < 1e-4,
                     f"differs by {worst:.1e} of the largest value")
            rng.shuffle(cloud)
    row.end()


main()
