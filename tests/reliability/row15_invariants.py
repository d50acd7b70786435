#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 15: energy, constraints and orthogonality over long runs of 3 conservative models x 3 integrators.

By default 10^5 steps; --steps 1000000 for a release. |Phi| < 1e-10 m, |A'A - I| < 1e-12, and the error of the energy
of the symmetric schemes has no trend: over the whole run it is at most twice that of the first half.
"""
import json

import matrix

MODELS = {"double_pendulum": 1e-3, "n_pendulum_2_spin": 1e-3, "heavy_top": 5e-4}
SYMMETRIC = ("rA-half-1-momentum", "rA-rattle")
INTEGRATORS = (*SYMMETRIC, "rA-half-2")


def options(parser):
    parser.add_argument("--steps", type=int, default=100000)


def main():
    row = matrix.Row("15 invariants", options)
    with matrix.scratch() as folder:
        for model, step in MODELS.items():
            for integrator in INTEGRATORS:
                command = [row.hilda, "run", model, "--integrator", integrator, "--step", step,
                           "--interval", repr(step * row.options.steps / 1000), "--quiet", "--output", "out"]
                drifts, last = [], None
                row.run(["rm", "-rf", "out"], cwd=folder)
                for part in (0.5, 1):
                    last = row.run([*command, "--end", repr(part * row.options.steps * step),
                                    *(["--resume"] if part == 1 else [])], cwd=folder, limit=3600)
                    if last.code == 0:
                        of_run = json.loads((folder / "out/summary.json").read_text())
                        drifts.append(of_run["invariants"]["energy_drift"])
                what = f"{model} {integrator}"
                if len(drifts) < 2:
                    row.case(what, False, f"exit {last.code}: {last.err}")
                    continue
                found = of_run["invariants"]
                row.case(f"{what} constraints", found["constraint_norm"] < 1e-10, str(found))
                row.case(f"{what} orthogonality", found["orthogonality"] < 1e-12, str(found))
                if integrator in SYMMETRIC:
                    bounded = drifts[1] <= 2 * drifts[0] + 1e-12
                    row.case(f"{what} energy", bounded, f"drifts {drifts}: {found}")
    row.end()


main()
