#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 20: lines and branches that the tests execute, by gcov: at least 90 % of the lines and 75 % of the branches of
each room, and 97 % of the lines of the parsers.

Builds the programs and tests with --coverage in build/coverage (an hour), and runs the tests of --rooms, by default io
and granular; all rooms with --rooms io,lie,dae,contact,granular,reference,studies.
"""
import collections
import json
import os
import pathlib
import subprocess

import matrix

PARSERS = ("io/json_parser.cpp", "io/expression.cpp", "io/csv.cpp", "io/archive.cpp", "contact/mesh/mesh_file.cpp")


def options(parser):
    parser.add_argument("--rooms", default="io,granular")


def main():
    row = matrix.Row("20 coverage", options)
    build = matrix.SOURCE / "build/coverage"
    rooms = row.options.rooms.split(",")
    subprocess.run(["cmake", "-S", matrix.SOURCE, "-B", build, "-G", "Ninja", "-D", "CMAKE_BUILD_TYPE=Debug",
                    "-D", "CMAKE_CXX_FLAGS=--coverage -fprofile-abs-path", "-D", "HILDA_PCH=OFF",
                    "-D", "HILDA_CCACHE=OFF", "-D", "HILDA_CUDA=OFF"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", build, "--target", *(f"hilda_test_{room}" for room in rooms)],
                   check=True, stdout=subprocess.DEVNULL)
    for counts in build.rglob("*.gcda"):
        counts.unlink()
    for room in rooms:
        subprocess.run([build / f"tests/hilda_test_{room}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                       env=dict(os.environ, OMP_NUM_THREADS="1"), check=False)
    lines, branches = collections.defaultdict(dict), collections.defaultdict(dict)
    for counts in build.rglob("*.gcda"):
        report = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities", counts],
                                capture_output=True, text=True, cwd=build, check=False)
        for text in filter(None, report.stdout.split("\n")):
            for file in json.loads(text)["files"]:
                name = pathlib.Path(file["file"])
                if not name.is_relative_to(matrix.SOURCE):
                    continue
                name = str(name.relative_to(matrix.SOURCE))
                for line in file["lines"]:
                    at = (name, line["line_number"])
                    lines[name][at] = lines[name].get(at, 0) + line["count"]
                    for k, branch in enumerate(line["branches"]):
                        if not branch["throw"]:
                            branches[name][(*at, k)] = branches[name].get((*at, k), 0) + branch["count"]

    def share(counts, chosen):
        all_counts = [count for name, of_file in counts.items() if chosen(name) for count in of_file.values()]
        return sum(count > 0 for count in all_counts) / len(all_counts) if all_counts else 0
    for room in rooms:
        of_room = lambda name, room=room: name.startswith(room + "/")
        for what, counts, limit in (("lines", lines, 0.9), ("branches", branches, 0.75)):
            found = share(counts, of_room)
            print(f"{room} {what}: {100 * found:.1f} %")
            row.case(f"{room} {what}", found >= limit, f"{100 * found:.1f} %")
    for parser in PARSERS:
        if parser.split("/")[0] in rooms:
            found = share(lines, lambda name, parser=parser: name == parser)
            row.case(parser, found >= 0.97, f"{100 * found:.1f} % of the lines")
    row.end()


main()
