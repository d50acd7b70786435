#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 16: the memory of long runs does not grow.

Two models and a bed of grains, by default 20 s each; --seconds 86400 for the soak of a release. The resident memory
grows by less than 1 MB after the first fifth of the time.
"""
import json
import pathlib
import subprocess
import time

import matrix


def options(parser):
    parser.add_argument("--seconds", type=float, default=20, help="wall time of each run")


def resident(process):
    for line in pathlib.Path(f"/proc/{process}/status").read_text().split("\n"):
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) * 1024
    return 0


def main():
    row = matrix.Row("16 soak", options)
    with matrix.scratch() as folder:
        bed = json.loads((matrix.SOURCE / "granular/cases/bed.json").read_text())
        bed["fill"][0]["high"] = [0.03, 0.02, 0.01]
        bed.update(end=1000, interval=0.1, frame_interval=1000)
        (folder / "bed.json").write_text(json.dumps(bed))
        run = ["--end", "1e6", "--interval", "10", "--quiet", "--checkpoint", "1", "--output"]
        commands = {"double_pendulum": [row.hilda, "run", "double_pendulum", *run, "a"],
                    "four_link": [row.hilda, "run", "four_link", *run, "b"],
                    "grains": [row.granular, "bed.json", "--quiet", "--checkpoint", "1", "--output", "c"]}
        for name, command in commands.items():
            with subprocess.Popen(command, cwd=folder, env=row.environment, stderr=subprocess.PIPE,
                                  text=True) as process:
                time.sleep(row.options.seconds / 5)
                ended = process.poll()
                first = resident(process.pid) if ended is None else 0
                most = first
                until = matrix.now() + 0.8 * row.options.seconds
                while matrix.now() < until and process.poll() is None:
                    time.sleep(min(1, row.options.seconds / 20))
                    most = max(most, resident(process.pid) if process.poll() is None else 0)
                alive = process.poll() is None
                process.kill()
                why = "" if alive else f"ended: {process.stderr.read()} "
                row.case(name, alive and most - first < 1 << 20, f"{why}{first >> 10} to {most >> 10} KiB")
    row.end()


main()
