#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 20: lines and branches that the tests execute, by gcov: at least 90 % of the lines and 75 % of the branches of
each room, and all lines of the parsers.

Builds the programs and tests with --coverage in build/coverage (an hour), and runs the tests of --rooms without those
named (long), by default of io and granular; all rooms with --rooms io,lie,dae,contact,granular,reference,studies. For
granular also the tests of its program. Branches to the handling of an exception are not counted (gcovr:
--exclude-throw-branches), nor are lines without code of their own, such as a closing brace to which gcc assigns the
destructors that run for an exception (gcovr: --exclude-noncode-lines). --list prints the missing lines.
"""
import collections
import json
import re
import subprocess
import sys

import matrix

PARSERS = ("io/json_parser.cpp", "io/expression.cpp", "io/csv.cpp", "io/archive.cpp", "contact/mesh/mesh_file.cpp")


def options(parser):
    parser.add_argument("--rooms", default="io,granular")
    parser.add_argument("--list", action="store_true", help="print the lines of each file that no test executes")
    parser.add_argument("--no-build", action="store_true", help="use the programs that are built")


def build_programs(build, rooms):
    # ccache would reuse objects of another clone, which write their counts there.
    subprocess.run(["cmake", "-S", matrix.SOURCE, "-B", build, "-G", "Ninja", "-D", "CMAKE_BUILD_TYPE=Debug",
                    "-D", "CMAKE_CXX_FLAGS=--coverage -fprofile-abs-path", "-D", "HILDA_CCACHE=OFF",
                    "-D", "HILDA_CUDA=OFF"], check=True, stdout=subprocess.DEVNULL)
    programs = ["hilda_granular_program"] if "granular" in rooms else []
    subprocess.run(["cmake", "--build", build, "--target", *(f"hilda_test_{room}" for room in rooms), *programs],
                   check=True, stdout=subprocess.DEVNULL)


def run_tests(row, build, rooms):
    for counts in build.rglob("*.gcda"):
        counts.unlink()
    commands = {f"tests of {room}": [build / f"tests/hilda_test_{room}", "~*(long)*"] for room in rooms}
    if "granular" in rooms:
        commands["tests of hilda-granular"] = [sys.executable, matrix.SOURCE / "tests/granular/exit_test.py",
                                               build / "hilda-granular"]
    for name, command in commands.items():
        ended = row.run(command, limit=7200, env=dict(row.environment, OMP_NUM_THREADS="1"))
        row.case(name, ended.code == 0, ended.out[-300:] + ended.err[-300:])


class Lines:
    """The text of the lines of the source"""

    def __init__(self):
        self.of_file = {}

    def has_code(self, name, line):
        if name not in self.of_file:
            self.of_file[name] = (matrix.SOURCE / name).read_text().split("\n")
        return re.search(r"\w", self.of_file[name][line - 1].split("//")[0]) is not None


def read_counts(build):
    """Counts of the lines and of the branches: name of the file -> (line, number of the branch) -> count"""
    lines, branches, source = collections.defaultdict(dict), collections.defaultdict(dict), Lines()
    for counts in build.rglob("*.gcda"):
        report = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities", counts],
                                capture_output=True, text=True, cwd=build, check=False)
        for text in filter(None, report.stdout.split("\n")):
            for file in json.loads(text)["files"]:
                name = (build / file["file"]).resolve()
                if not name.is_relative_to(matrix.SOURCE) or name.is_relative_to(build):
                    continue
                name = str(name.relative_to(matrix.SOURCE))
                for line in file["lines"]:
                    at = line["line_number"]
                    if not source.has_code(name, at):
                        continue
                    lines[name][at] = lines[name].get(at, 0) + line["count"]
                    for k, branch in enumerate(line["branches"]):
                        if not branch["throw"]:
                            branches[name][at, k] = branches[name].get((at, k), 0) + branch["count"]
    return lines, branches


def share(counts, chosen):
    all_counts = [count for name, of_file in counts.items() if chosen(name) for count in of_file.values()]
    return sum(count > 0 for count in all_counts) / len(all_counts) if all_counts else 0


def main():
    row = matrix.Row("20 coverage", options)
    build = matrix.SOURCE / "build/coverage"
    rooms = row.options.rooms.split(",")
    if not row.options.no_build:
        build_programs(build, rooms)
    run_tests(row, build, rooms)
    lines, branches = read_counts(build)
    for room in rooms:
        for what, counts, limit in (("lines", lines, 0.9), ("branches", branches, 0.75)):
            found = share(counts, lambda name, room=room: name.startswith(room + "/"))
            print(f"{room} {what}: {100 * found:.1f} %")
            row.case(f"{room} {what}", found >= limit, f"{100 * found:.1f} %")
        for name in sorted(lines) if row.options.list else []:
            missing = [line for line, count in sorted(lines[name].items()) if count == 0]
            if name.startswith(room + "/") and missing:
                print(f"{name}: {missing}")
    for parser in PARSERS:
        if parser.split("/")[0] in rooms:
            missing = [line for line, count in sorted(lines[parser].items()) if count == 0]
            row.case(parser, lines[parser] and not missing, f"lines {missing}")
    row.end()


main()
