#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 22: no test fails now and then. Runs the tests of a regular expression --repeats times in random order, by
default 3 times those of io, granular (without the long ones) and the house; for a release `--repeats 20 --tests .`. A
case is one test, all repetitions."""
import collections
import os
import re

import matrix


def options(parser):
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--tests", default="^(io|house|fuzz):|^granular:[^(]*$")


def main():
    row = matrix.Row("22 flakiness", options)
    results = collections.defaultdict(list)
    for _ in range(row.options.repeats):
        ended = row.run(["ctest", "--test-dir", row.build, "--tests-regex", row.options.tests,
                         "--parallel", os.cpu_count() or 1, "--schedule-random", "--timeout", 600], limit=7200)
        for name, result in re.findall(r"Test +#\d+: (.*?) \.*\s*(Passed|\*\*\*\S+)", ended.out):
            results[name].append(result)
    for name, found in results.items():
        row.case(name, found == ["Passed"] * row.options.repeats, str(found))
    row.end()


main()
