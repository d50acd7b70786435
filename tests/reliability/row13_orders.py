#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 13: the measured order of each integrator is the declared one.

Up to 60 slopes: 5 integrators x 4 models x position, velocity, multipliers, fitted over the steps above rounding. A slope passes from
0.1 below the declared order. A better slope passes and is reported.
"""
import json

import matrix

INTEGRATORS = "rA-half-1,rA-half-1-momentum,rA-rattle,rA-genalpha,rA-full-1"
STEPS = {"double_pendulum": "4e-3,2e-3,1e-3,5e-4,2.5e-4", "n_pendulum_2_spin": "1e-3,5e-4,2.5e-4,1.25e-4,6.25e-5", "slider_crank": "2e-3,1e-3,5e-4,2.5e-4,1.25e-4",
         "heavy_top": "2e-3,1e-3,5e-4,2.5e-4,1.25e-4"}


def main():
    row = matrix.Row("13 orders")
    with matrix.scratch() as folder:
        for model, steps in STEPS.items():
            ended = row.run([row.hilda, "study", "convergence", "--problem", model, "--integrator", INTEGRATORS, "--steps", steps, "--no-plot", "--output", model],
                            cwd=folder, limit=1800)
            file = folder / model / "study.json"
            series = json.loads(file.read_text())["series"] if ended.code == 0 and file.exists() else []
            if len(series) != 5:
                row.case(model, False, f"exit {ended.code}, {len(series)} integrators: {ended.err}")
            for one in series:
                for quantity, declared in (("r", one["declared_order"]), ("v", one["declared_order"]), ("Q", one["declared_order_lambda"])):
                    slope = one["fitted_order"].get(quantity)
                    what = f"{model} {one['integrator']} {quantity}: {slope} where {declared} is declared"
                    if slope is None:  # all errors are at rounding
                        print(f"not counted: {what}")
                        continue
                    row.case(what, slope > declared - 0.1)
                    if slope > declared + 0.1:
                        print(f"better: {what}")
    row.end()


main()
