#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 20: lines and branches that the tests execute, by gcov: at least 90 % of the lines and 75 % of the branches of
each room, and all lines of the parsers.

Builds the programs and tests with --coverage in build/coverage (an hour), and runs the tests of --rooms, by default of
the core, without those named (long). For granular also the tests of its program: exit codes, schema, and runs that are
interrupted, damaged and continued. A file counts as executed by the tests of any of these rooms: a part of io and lie
is tested with the cases and models of the rooms above. --list prints the lines without execution, and those with a
condition that has had one outcome only.

Counted are the outcomes of the conditions in the source. About half of the branches that gcov reports are not in the
source but added by gcc, and are left out:
- a call that may throw has two branches, to the next statement and to the handling of the exception. gcovr
  (--exclude-throw-branches) leaves out the second. The first then repeats the count of its line, so both are left out.
- branches of lines without a part of a condition: the head of an if, for, while or switch, or a statement with ?, && or
  ||. Such branches are the loop with which gcc destroys the elements of an initialiser list, or the guard of a static
  variable (lcov: --filter branch). What gcc adds to lines with a part of a condition remains counted.
The instances of a template are one piece of source: an outcome counts as executed if one of them has had it. Lines
without code of their own, such as a closing brace to which gcc assigns destructors, are not counted (gcovr:
--exclude-noncode-lines).

The validations of granular count as any other file of the room. Their tests named (long) run here if they take a
minute or two with these programs, which are 10 to 20 times slower: brick; head-on and oblique are among the other
tests. stacking and waves would take hours; they run as studies, which check their results.
"""
import collections
import json
import re
import subprocess
import sys

import matrix

CORE = "io,lie,dae,contact,granular"
PARSERS = ("io/json_parser.cpp", "io/expression.cpp", "io/formats/csv.cpp", "io/archive.cpp", "io/formats/mesh_file.cpp")


def options(parser):
    parser.add_argument("--rooms", default=CORE)
    parser.add_argument("--list", action="store_true", help="print the lines of each file that no test executes")
    parser.add_argument("--no-build", action="store_true", help="use the programs that are built")
    parser.add_argument("--no-run", action="store_true", help="use the counts of the last run")


def build_programs(build, rooms):
    # ccache would reuse objects of another clone, which write their counts there.
    subprocess.run(["cmake", "-S", matrix.SOURCE, "-B", build, "-G", "Ninja", "-D", "CMAKE_BUILD_TYPE=Debug",
                    "-D", "CMAKE_CXX_FLAGS=--coverage -fprofile-abs-path", "-D", "HILDA_CCACHE=OFF",
                    "-D", "HILDA_CUDA=OFF"], check=True, stdout=subprocess.DEVNULL)
    programs = ["hilda_granular_program"] if "granular" in rooms else []
    subprocess.run(["cmake", "--build", build, "--target", *(f"hilda_test_{room}" for room in rooms), *programs],
                   check=True, stdout=subprocess.DEVNULL)


def commands(build, room):
    """The tests of a room: name -> command"""
    result = {f"tests of {room}": [build / f"tests/hilda_test_{room}", "~*(long)*"]}
    if room == "granular":
        result["validation brick"] = [build / "tests/hilda_test_granular", "validation: brick (long)"]
        program, tests = build / "hilda-granular", matrix.SOURCE / "tests/granular"
        for name in ("exit_test.py", "schema_test.py"):
            result[name] = [sys.executable, tests / name, program]
        for name in ("ends", "longer"):
            result[f"persistence_test.py {name}"] = [sys.executable, tests / "persistence_test.py", name, program]
    return result


def run_tests(row, build, rooms):
    for counts in build.rglob("*.gcda"):
        counts.unlink()
    for room in rooms:
        for name, command in commands(build, room).items():
            ended = row.run(command, limit=7200, env=dict(row.environment, OMP_NUM_THREADS="1"))
            row.case(name, ended.code == 0, ended.out[-300:] + ended.err[-300:])


HEAD = re.compile(r"\b(?:if|for|while|switch)\b(?:\s+constexpr)?\s*\(")
OPERATOR = re.compile(r"\?|\|\||(?<=\s)&&")
# Strings and characters, comments, lines of the preprocessor
TEXT = re.compile(r'R"\((.*?)\)"|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|(?<![0-9a-zA-Z])\'(?:\\.|[^\'\\\n])*\'|'
                  r"^\s*#[^\n]*", re.DOTALL | re.MULTILINE)


class Source:
    """The lines of a file that have code, and those that have a part of a condition"""

    def __init__(self, text):
        text = TEXT.sub(lambda found: re.sub(r"[^\n]", "x" if '"' in found[0][:2] else " ", found[0]), text)
        self.with_code = {n for n, line in enumerate(text.split("\n"), 1) if re.search(r"\w", line)}
        self.with_condition = set()
        # The head of an if or a loop is a statement of its own.
        ends = [place for head in HEAD.finditer(text) for place in (head.start(), closing(text, head.end()))]
        for begin, end in zip(ends[::2], ends[1::2]):
            self.include(text, begin, end)
        ends = sorted({0, len(text), *ends, *(found.start() for found in re.finditer(r"[;{}]", text))})
        for begin, end in zip(ends, ends[1:]):
            if OPERATOR.search(text, begin, end):
                self.include(text, begin + 1, end)

    def include(self, text, begin, end):
        begin += len(text[begin:end]) - len(text[begin:end].lstrip())
        first = text.count("\n", 0, begin) + 1
        self.with_condition.update(range(first, first + text.count("\n", begin, end) + 1))


def closing(text, place):
    """The parenthesis that closes the one before a place"""
    depth = 1
    while depth > 0:
        depth += {"(": 1, ")": -1}.get(text[place], 0)
        place += 1
    return place - 1


def outcomes(branches):
    """The branches of a line without calls that may throw, each of which is a pair of branches, one to a handler"""
    k = 0
    while k < len(branches):
        if k + 1 < len(branches) and branches[k]["throw"] != branches[k + 1]["throw"]:
            k += 2
            continue
        if not branches[k]["throw"]:
            yield branches[k]["count"]
        k += 1


def read_counts(build):
    """Counts of the lines and of the branches: name of the file -> (line, number of the branch) -> count"""
    lines, branches, sources = collections.defaultdict(dict), collections.defaultdict(dict), {}
    for counts in build.rglob("*.gcda"):
        report = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities", counts],
                                capture_output=True, text=True, cwd=build, check=False)
        for text in filter(None, report.stdout.split("\n")):
            for file in json.loads(text)["files"]:
                name = (build / file["file"]).resolve()
                if not name.is_relative_to(matrix.SOURCE) or name.is_relative_to(build):
                    continue
                name = str(name.relative_to(matrix.SOURCE))
                if name not in sources:
                    sources[name] = Source((matrix.SOURCE / name).read_text())
                for line in file["lines"]:
                    at = line["line_number"]
                    if at not in sources[name].with_code:
                        continue
                    lines[name][at] = lines[name].get(at, 0) + line["count"]
                    if at in sources[name].with_condition:
                        for k, count in enumerate(outcomes(line["branches"])):
                            branches[name][at, k] = branches[name].get((at, k), 0) + count
    return lines, branches


def share(counts, folder):
    all_counts = [count for name, of_file in counts.items() if name.startswith(folder) for count in of_file.values()]
    return sum(count > 0 for count in all_counts) / len(all_counts) if all_counts else 0


def main():
    row = matrix.Row("20 coverage", options)
    build = matrix.SOURCE / "build/coverage"
    rooms = row.options.rooms.split(",")
    if not row.options.no_build:
        build_programs(build, rooms)
    if not row.options.no_run:
        run_tests(row, build, rooms)
    lines, branches = read_counts(build)
    for room in rooms:
        for what, counts, limit in (("lines", lines, 0.9), ("branches", branches, 0.75)):
            found = share(counts, room + "/")
            print(f"{room} {what}: {100 * found:.1f} %")
            row.case(f"{room} {what}", found >= limit, f"{100 * found:.1f} %")
        for name in sorted(lines) if row.options.list else []:
            missing = [line for line, count in sorted(lines[name].items()) if count == 0]
            one_outcome = sorted({at for (at, _), count in branches[name].items() if count == 0} - set(missing))
            if name.startswith(room + "/") and (missing or one_outcome):
                print(f"{name}: lines {missing}, branches {one_outcome}")
    for parser in PARSERS:
        if parser.split("/")[0] in rooms:
            missing = [line for line, count in sorted(lines[parser].items()) if count == 0]
            row.case(parser, lines[parser] and not missing, f"lines {missing}")
    row.end()


main()
