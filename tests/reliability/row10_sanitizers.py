#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 10: no report of a sanitizer or of valgrind, and no suppression of our own code.

Parts (--parts, by default valgrind,thread):
  valgrind  memcheck on 30 tests of the build under test (--build)
  thread    ThreadSanitizer (preset tsan, clang) over grains with 2 to 4 threads and studies with --jobs 2
  address   the tests of the preset debug: address and undefined-behaviour sanitizers, assertions, matrices of NaN
            (an hour)
The presets are built first.
"""
import json
import re
import subprocess

import matrix

# Of libgomp and libomp, which are not instrumented, nothing is checked.
TSAN = "halt_on_error=0 exitcode=66 ignore_noninstrumented_modules=1"
VALGRIND = ["valgrind", "--error-exitcode=99", "--leak-check=full", "--show-leak-kinds=definite",
            "--errors-for-leak-kinds=definite", "--quiet"]
NOT_WITH_VALGRIND = ("(long)", "allocat", "order")  # in names of tests
STUDIES = (["convergence", "--problem", "double_pendulum,slider_crank", "--integrator", "rA-half-1,rA-rattle",
            "--steps", "4e-3,2e-3", "--end", "0.05"],
           ["energy", "--problem", "double_pendulum,four_link", "--end", "0.05"],
           ["sweep", "double_pendulum", "--sweep", "/bodies/0/mass=1,2,3,4", "--end", "0.05"])


def options(parser):
    parser.add_argument("--parts", default="valgrind,thread")


def valgrind(row, folder):
    tests = []
    for room, most in (("io", 10), ("lie", 6), ("contact", 7), ("granular", 7)):
        program = row.build / f"tests/hilda_test_{room}"
        listed = row.run([program, "--list-test-names-only"]).out.split("\n")
        names = [name.strip() for name in listed if name.strip()]
        names = [name for name in names if not any(word in name for word in NOT_WITH_VALGRIND)]
        tests += [(program, name) for name in names[:: max(1, len(names) // most)][:most]]
    environment = dict(row.environment, OMP_NUM_THREADS="1")
    for program, name in tests:
        escaped = name.replace("\\", "\\\\").replace(",", "\\,").replace("[", "\\[")
        ended = row.run([*VALGRIND, program, escaped], env=environment, limit=1200)
        row.case(f"memcheck {program.name} {name}", ended.code == 0,
                 f"exit {ended.code}: {ended.err[-300:]}{ended.out[-200:] if ended.code != 99 else ''}")


def thread(row, folder):
    build = matrix.SOURCE / "build/tsan"
    subprocess.run(["cmake", "--preset", "tsan"], cwd=matrix.SOURCE, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", build, "--target", "hilda_program", "hilda_granular_program"],
                   check=True, stdout=subprocess.DEVNULL)
    environment = dict(row.environment, TSAN_OPTIONS=TSAN)
    for name, steps in (("bed", 1000), ("shaken_box", 200)):
        case = json.loads((matrix.SOURCE / f"granular/cases/{name}.json").read_text())
        if name == "bed":
            case["fill"][0]["high"] = [0.03, 0.02, 0.01]
        (folder / f"{name}.json").write_text(json.dumps(case))
        command = [build / "hilda-granular", f"{name}.json", "--end", repr(steps * case["step"]), "--quiet", "--force",
                   "--output", "out", "--threads"]
        for threads in (2, 3, 4):
            report(row, f"{name} with {threads} threads", [*command, threads], folder, environment)
    for study in STUDIES:
        command = [build / "hilda", "study", *study, "--jobs", 2, "--no-plot", "--force", "--output", "out"]
        report(row, f"study {study[0]} --jobs 2", command, folder, environment)


def report(row, what, command, folder, environment):
    ended = row.run(command, cwd=folder, env=environment, limit=3600)
    reports = re.findall(r"WARNING: ThreadSanitizer: .*", ended.err)
    row.case(what, ended.code == 0 and not reports, f"exit {ended.code}, {len(reports)} reports: {ended.err[:1500]}")


def address(row, folder):
    build = matrix.SOURCE / "build/debug"
    subprocess.run(["cmake", "--preset", "debug"], cwd=matrix.SOURCE, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", build], check=True, stdout=subprocess.DEVNULL)
    ended = row.run(["ctest", "--preset", "debug"], cwd=matrix.SOURCE, limit=4 * 3600)
    for name, result in re.findall(r"Test +#\d+: (.*?) \.*\s*(Passed|\*\*\*\S+)", ended.out):
        row.case(f"debug {name}", result == "Passed", result)


def main():
    row = matrix.Row("10 sanitizers", options)
    parts = {"valgrind": valgrind, "thread": thread, "address": address}
    with matrix.scratch() as folder:
        for part in row.options.parts.split(","):
            parts[part](row, folder)
    row.end()


main()
