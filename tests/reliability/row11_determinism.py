#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 11: the bytes of the tables do not depend on the number of threads or on the repetition.

6 cases of grains and of studies x threads (jobs) 1, 2, 3, 4, 8, 16 x repetitions: by default 1 (36 runs); --repeats 3
for 108.
"""
import csv
import hashlib
import json

import matrix


def options(parser):
    parser.add_argument("--repeats", type=int, default=1)


def without_times(file):
    """The table without the columns of processor times"""
    with open(file) as table:
        rows = list(csv.reader(table))
    kept = [k for k, name in enumerate(rows[0]) if "seconds" not in name]
    return "\n".join(",".join(row[k] for k in kept) for row in rows)


def main():
    row = matrix.Row("11 determinism", options)
    with matrix.scratch() as folder:
        bed = json.loads((matrix.SOURCE / "granular/cases/bed.json").read_text())
        shaken = json.loads((matrix.SOURCE / "granular/cases/shaken_box.json").read_text())
        bed["fill"][0]["high"] = [0.03, 0.02, 0.02]
        chung = {**bed, "integrator": "chung", "orientation": True}
        commands = {}
        for name, case, steps in (("bed", bed, 400), ("shaken", shaken, 100), ("chung", chung, 300)):
            (folder / f"{name}.json").write_text(json.dumps(case))
            end = repr(steps * case["step"])
            commands[name] = [row.granular, f"{name}.json", "--end", end, "--interval", repr(50 * case["step"]),
                              "--quiet", "--contacts", "--threads"]
        studies = (["convergence", "--problem", "double_pendulum", "--steps", "4e-3,2e-3", "--end", "0.5"],
                   ["energy", "--problem", "slider_crank", "--end", "0.5"],
                   ["compare", "--problem", "four_link", "--steps", "1e-3", "--end", "0.3"])
        for study in studies:
            commands[study[0]] = [row.hilda, "study", *study, "--no-plot", "--force", "--jobs"]
        for name, command in commands.items():
            first = None
            for threads in (1, 2, 3, 4, 8, 16):
                for repeat in range(row.options.repeats):
                    row.run(["rm", "-rf", "out"], cwd=folder)
                    ended = row.run([*command, threads, "--output", "out"], cwd=folder, limit=600)
                    files = sorted((folder / "out").rglob("*.csv")) if ended.code == 0 else []
                    text = "".join(file.name + without_times(file) for file in files)
                    digest = hashlib.sha256(text.encode()).hexdigest()
                    first = first or digest
                    row.case(f"{name} {threads} threads, {repeat}", ended.code == 0 and files and digest == first,
                             f"exit {ended.code}, {digest}: {ended.err}")
    row.end()


main()
