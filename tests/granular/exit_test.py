#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""hilda-granular says in its exit code and in one line what is wrong.

    exit_test.py PROGRAM
"""
import json
import re
import resource
import subprocess
import sys
import tempfile

from persistence_test import CASE, Runs, expect


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        here = runs.folder
        short = runs.case("short", end=1e-4, every=5e-5)

        def refused(code, message, *arguments, case=short, **options):
            err = runs.finish(case, "--quiet", *arguments, code=code, **options)
            lines = err.strip().split("\n")
            expect(len(lines) == 1 and re.search(f"^hilda: error.*{message}", lines[0]), f"{message} in one line: {err}")

        refused(2, "--checkpoin", "--checkpoin", "1")
        refused(2, "--device: must be cpu, cuda or cuda:N", "--device", "gpu")
        refused(7, "--device cuda:99: ", "--device", "cuda:99")
        refused(3, "none.json: is not there", case="none")
        expect(sorted(file.name for file in here.iterdir()) == ["short.json"], "nothing is written by what is refused")

        expect(runs.finish(short, "--quiet") == "", "a good case says nothing where it is told so")
        expect((here / "out" / "short" / "summary.json").exists(), "the output is in out/NAME")
        refused(2, "out/short: is not empty; --force starts it again, --resume goes on")
        (here / "other").mkdir()
        (here / "other" / "letter").write_text("precious")
        refused(2, "other: is not empty", "--output", "other")
        expect((here / "other" / "letter").read_text() == "precious", "what lies there stays")
        refused(5, "short.json/out", "--output", "short.json/out")

        # a disk that is full
        process = subprocess.run([sys.argv[1], "short.json", "--output", "full", "--quiet", "--threads", "1"], cwd=here,
                                 capture_output=True, text=True, env=runs.environment,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000)))
        expect(process.returncode == 5 and "File too large" in process.stderr, f"{process.returncode}: {process.stderr}")
        expect(not list((here / "full").rglob("*.new")), "no half of a file is left")

        # above the limit of stability a step is refused, and taken when it is insisted on
        coarse = runs.case("coarse", step=3e-5, end=3e-5)
        refused(3, r"coarse.json:1:\d+ \(/step\): must not be above .* got 3e-05; --force", case=coarse)
        expect("warning" in runs.finish(coarse, "--force"), "a step that is not stable is taken with --force")

        # lost grains: who, when, and how fast
        one = {"r": [0.01, 0.01, 0.05], "radius": 1e-3, "material": "glass"}
        where = r"particle {} {} at t = {}\d* s, with a velocity of \({}\) m/s"
        leaves = runs.case("leaves", fill=[], particles=[one, dict(one, r=[0.01, 0.01, 0.06], v=[0, 0, 2])], gravity=[0, 0, 0], boundaries=CASE["boundaries"][:2])
        refused(4, where.format(1, "has left the domain", "0.01", "0, 0, 2"), case=leaves)
        fast = runs.case("fast", fill=[], particles=[dict(one, v=[0, 0, 500])], gravity=[0, 0, 0], boundaries=CASE["boundaries"][:2])
        refused(4, where.format(0, "moves more than a cell in a step", "", "0, 0, 500"), "--force", case=fast)
        for name in (leaves, fast):
            summary = json.loads((here / "out" / name / "summary.json").read_text())
            expect(summary["status"] == "particle_lost" and "velocity" in summary["message"], f"{summary}")

        floor = {"name": "floor", "type": "plane", "normal": [0, 0, 1], "v": [0, 0, "sqrt(1e-4-t)"], "material": "steel"}
        refused(4, r"boundary 'floor': v is not finite at t = 0.0001\d* s", case=runs.case("sinks", boundaries=[floor]))
        print("exit codes 0, 2, 3, 4, 5, 7")


if __name__ == "__main__":
    main()
