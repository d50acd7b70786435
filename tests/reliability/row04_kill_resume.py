#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 4: runs that are killed at random times and resumed write the same tables as an uninterrupted run.

5 models x 8 integrators. Each run is killed by SIGKILL until it has been killed --kills times, by default 4 (160
kills); 20 for a release (800 kills). A case is one kill: afterwards there is a complete checkpoint or none, and the
final tables are equal.
"""
import random

import matrix

MODELS = {"double_pendulum": 4, "four_link": 4, "slider_crank": 3, "n_pendulum_2_spin": 3, "andrews_squeezer": 0.03}
INTEGRATORS = {"rA-half-1": 1e-3, "rA-half-1-momentum": 1e-3, "rA-full-1": 1e-3, "rA-rattle": 1e-3, "rA-rkmk-4": 1e-3,
               "rA-dp-5": "adaptive", "rA-dop853": "adaptive", "rA-radau-5": "adaptive"}


def options(parser):
    parser.add_argument("--kills", type=int, default=4, help="kills of each run; default: 4, for a release 20")
    parser.add_argument("--seed", type=int, default=1)


def main():
    row = matrix.Row("4 kill and resume", options)
    rng = random.Random(row.options.seed)
    with matrix.scratch() as folder:
        for model, end in MODELS.items():
            for integrator, step in INTEGRATORS.items():
                steps = ["--rtol", 1e-10] if step == "adaptive" else ["--step", step]
                if model == "andrews_squeezer" and step != "adaptive":
                    steps = ["--step", 1e-5]
                interval = 5e-5 if model == "andrews_squeezer" else 5e-3
                command = [row.hilda, "run", model, "--integrator", integrator, *steps, "--end", end,
                           "--interval", interval, "--quiet"]
                begin = matrix.now()
                whole = row.run(command + ["--output", "whole", "--force"], cwd=folder, limit=600)
                taken = matrix.now() - begin
                killed, starts, torn = 0, 0, False
                row.run(["rm", "-rf", "parts"], cwd=folder)
                while killed < row.options.kills and starts < 20 * row.options.kills:
                    starts += 1
                    # After the start without a checkpoint, a run must be resumed or started again.
                    again = ["--resume"] if (folder / "parts/model.json").exists() else []
                    part = ["--output", "parts", "--checkpoint", 1e-3, *(again or ["--force"])]
                    complete = not row.killed_after(command + part, rng.uniform(0.01, 0.9 * taken), cwd=folder)
                    killed += not complete
                    if complete:  # more kills of a new run
                        torn = torn or matrix.tables(folder / "parts") != matrix.tables(folder / "whole")
                        row.run(["rm", "-rf", "parts"], cwd=folder)
                last = row.run(command + ["--output", "parts", "--resume"] if (folder / "parts/model.json").exists()
                               else command + ["--output", "parts", "--force"], cwd=folder, limit=600)
                expected = matrix.tables(folder / "whole")
                same = not torn and len(expected) > 0 and matrix.tables(folder / "parts") == expected
                for kill in range(row.options.kills):
                    row.case(f"{model} {integrator} kill {kill}",
                             whole.code == 0 and last.code == 0 and same and kill < killed,
                             f"{killed} kills, exit {whole.code}, {last.code}: {last.err}")
    row.end()


main()
