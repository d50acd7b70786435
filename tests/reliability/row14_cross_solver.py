#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 14: half-implicit and fully implicit schemes and IDA agree on 6 models: the difference to IDA falls with the
order of the scheme."""
import csv
import math

import matrix

MODELS = {"single_pendulum": 1, "double_pendulum": 1, "four_link": 0.5, "slider_crank": 0.5, "n_pendulum_2_spin": 0.5,
          "heavy_top": 0.2}
ORDERS = {"rA-half-1": 1, "rA-half-1-momentum": 2, "rA-full-1": 1}


def last_positions(file):
    with open(file) as table:
        rows = list(csv.DictReader(table))
    return [float(value) for name, value in rows[-1].items() if name.endswith((".x", ".y", ".z", ".rx", ".ry", ".rz"))]


def main():
    row = matrix.Row("14 cross-solver")
    with matrix.scratch() as folder:
        for model, end in MODELS.items():
            def positions(integrator, *options, model=model, end=end):
                ended = row.run([row.hilda, "run", model, "--integrator", integrator, "--end", end, "--interval", end,
                                 "--quiet", "--force", "--output", "out", *options], cwd=folder, limit=600)
                return last_positions(folder / "out/trajectory.csv") if ended.code == 0 else []
            exact = positions("ida-rp", "--rtol", "1e-10")
            found, passed = [], len(exact) > 0
            for integrator, order in ORDERS.items():
                ends = [positions(integrator, "--step", step) for step in (1e-3, 2.5e-4)]
                errors = [math.dist(x, exact) if exact and x else math.nan for x in ends]
                slope = math.log(errors[0] / errors[1]) / math.log(4) if min(errors) > 0 else math.nan
                found.append(f"{integrator} {errors[0]:.1e} {errors[1]:.1e} order {slope:.2f}")
                passed = passed and (slope > order - 0.15 or errors[1] < 1e-9)
            row.case(model, passed, "; ".join(found))
    row.end()


main()
