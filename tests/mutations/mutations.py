#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Plausible faults, and the tests that find them.

tests/mutations/mutations.json lists faults: a text of a source file, and the text that replaces it. This script
applies them one by one to a copy of the source tree, builds the tests of the room with each, and runs them. A fault
that no test of its own room finds is a gap in these tests.

    tests/mutations/mutations.py                    all faults: about an hour on two processors
    tests/mutations/mutations.py --room lie 31 40   the faults of lie, and those with the numbers 31 and 40
    tests/mutations/mutations.py --check            only check that the list fits the source; builds nothing
    tests/mutations/mutations.py --write            write tests/mutations.md from the list; builds nothing

The last line is "mutations, CASES, PASSED", where PASSED counts the faults that a test has found. The exit code is 0
if that is at least 90 % of them, and 1 otherwise or if the list does not fit the source.
"""
import argparse
import glob
import html
import json
import os
import re
import shutil
import subprocess
import sys
import time

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
LIST = os.path.join("tests", "mutations", "mutations.json")
PAGE = os.path.join("tests", "mutations.md")
ROOMS = ["io", "lie", "dae", "contact", "granular"]
PARTS = ROOMS + ["reference", "run", "studies", "python", "tests", "examples", "docs", "cmake"]
LEAST = 0.9  # of the faults must be found

INTRODUCTION = """# Faults that the tests find

The table lists plausible faults: wrong signs, factors, indices and frames, missing terms, stale data, forgotten saves,
wrong tolerances and comparisons. Each is a small change of the source that compiles. The test named in the last
column fails with it. It belongs to the same room, so that a fault is found where it is made. "not shown" stands for a
fault that no test has found in the last complete run, or that is newer than it.

`tests/mutations/mutations.py` applies the faults one by one to a copy of the tree, builds the tests of the room and
runs them. Run it after a change of the tests, or for new code with new entries in `tests/mutations/mutations.json`:
a fault that survives shows what no test checks. The test suite itself only checks that each replaced text occurs
exactly once in its file and that the tests exist.

`tests/mutations/mutations.py --write` writes this page from the list. The replacements are shortened to one line.
"""


def error(text):
    print(f"hilda: error: mutations: {text}", file=sys.stderr)


def read(path):
    with open(path, encoding="utf-8") as f:
        return f.read()


def write(path, text):
    with open(path, "w", encoding="utf-8") as f:
        f.write(text)


def room_of(fault):
    return fault["file"].split("/")[0]


def test_names(room):
    """The names of the tests of a room. A name may consist of several string literals."""
    names = set()
    for path in glob.glob(os.path.join(ROOT, "tests", room, "**", "*.cpp"), recursive=True):
        for literals in re.findall(r'\bTEST_CASE\(\s*((?:"(?:[^"\\]|\\.)*"\s*)+)', read(path)):
            names.add("".join(re.findall(r'"((?:[^"\\]|\\.)*)"', literals)).replace('\\"', '"'))
    return names


def page(faults):
    def cell(text):
        line = " ".join(text.split()) or " "
        return "`" + line.replace("|", "\\|") + "`" if line.strip() else "(nothing)"

    rows = ["| number | fault | file | text | replaced by | found by |", "| --- | --- | --- | --- | --- | --- |"]
    for number, f in enumerate(faults, 1):
        found = f["killed_by"] or "not shown"
        rows.append(f"| {number} | {f['fault']} | {f['file']} | {cell(f['old'])} | {cell(f['new'])} | {found} |")
    killed = sum(bool(f["killed_by"]) for f in faults)
    of_rooms = ", ".join(
        f"{room} {sum(bool(f['killed_by']) for f in faults if room_of(f) == room)} of "
        f"{sum(room_of(f) == room for f in faults)}" for room in ROOMS)
    summary = f"Found: {killed} of {len(faults)} ({of_rooms})."
    return INTRODUCTION + "\n" + summary + "\n\n" + "\n".join(rows) + "\n"


def check(faults):
    """Whether the list fits the source and the page fits the list."""
    good = True
    tests = {room: test_names(room) for room in ROOMS}
    for number, f in enumerate(faults, 1):
        where = f"{LIST}: number {number}, {f['fault']}: "
        path = os.path.join(ROOT, f["file"])
        if room_of(f) not in ROOMS or not os.path.isfile(path):
            error(where + f"the file must be one of {', '.join(ROOMS)}, got {f['file']}")
            good = False
            continue
        count = read(path).count(f["old"])
        if count != 1 or f["old"] == f["new"]:
            error(where + f"the replaced text must occur once in {f['file']}, got {count} times: {f['old']!r}")
            good = False
        if f["killed_by"] and f["killed_by"] not in tests[room_of(f)]:
            error(where + f"no test of {room_of(f)} has the name {f['killed_by']!r}")
            good = False
    if not os.path.isfile(os.path.join(ROOT, PAGE)) or read(os.path.join(ROOT, PAGE)) != page(faults):
        error(f"{PAGE} differs from the list; write it with tests/mutations/mutations.py --write")
        good = False
    return good


def copy_tree(to):
    """Copies the source. Files with equal content keep their times, so that a second run builds little."""
    top = ["CMakeLists.txt", "CMakePresets.json", "README.md", "LICENSE", "CITATION.cff"]
    wanted = {name for name in top if os.path.isfile(os.path.join(ROOT, name))}
    for part in PARTS:
        for folder, folders, files in os.walk(os.path.join(ROOT, part)):
            folders[:] = [name for name in folders if name != "__pycache__"]
            wanted.update(os.path.relpath(os.path.join(folder, name), ROOT) for name in files)
    for folder, folders, files in os.walk(to):
        folders[:] = [name for name in folders if name != "build"]
        for name in files:
            if os.path.relpath(os.path.join(folder, name), to) not in wanted:
                os.remove(os.path.join(folder, name))
    for name in wanted:
        source, copy = os.path.join(ROOT, name), os.path.join(to, name)
        with open(source, "rb") as f:
            content = f.read()
        if os.path.isfile(copy):
            with open(copy, "rb") as f:
                if f.read() == content:
                    continue
        os.makedirs(os.path.dirname(copy), exist_ok=True)
        shutil.copyfile(source, copy)
        shutil.copymode(source, copy)


class Build:
    """A copy of the tree with its build folder"""

    def __init__(self, work, jobs):
        # The relative paths and options of tests/run: ccache then has most objects.
        self.tree, self.folder = os.path.join(work, "tree"), os.path.join(work, "tree", "build", "release")
        self.jobs, self.log = jobs, os.path.join(work, "log.txt")
        os.makedirs(work, exist_ok=True)
        copy_tree(self.tree)
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        self.call(["cmake", "-S", self.tree, "-B", self.folder, *generator, "-D", "CMAKE_BUILD_TYPE=Release",
                   "-D", "HILDA_TESTS=ON", "-D", "HILDA_WERROR=ON"]) or self.give_up()

    def call(self, command):
        with open(self.log, "w", encoding="utf-8") as log:
            return subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, check=False).returncode == 0

    def give_up(self):
        error(f"the unchanged source does not build; see {self.log}")
        sys.exit(1)

    def build(self, room):
        return self.call(["cmake", "--build", self.folder, "--target", "hilda_test_" + room,
                          "--parallel", str(self.jobs)])

    def run(self, room, tests, limit):
        """Runs the tests up to the first failure: the name of the test that fails, or None."""
        program = os.path.join(self.folder, "tests", "hilda_test_" + room)
        environment = dict(os.environ, OMP_NUM_THREADS="1", OMP_WAIT_POLICY="passive")
        report = os.path.join(self.folder, "tests", "report.xml")
        code, suffix = 0, ""
        with open(report, "w", encoding="utf-8") as out:
            try:
                code = subprocess.run([program, tests, "--abort", "-r", "xml"], stdout=out, env=environment,
                                      stderr=subprocess.DEVNULL, cwd=self.folder, timeout=limit,
                                      check=False).returncode
            except subprocess.TimeoutExpired:
                code, suffix = 1, " (does not end)"
        if code == 0:
            return None
        started = re.findall(r'<TestCase name="([^"]*)"', open(report, encoding="utf-8", errors="replace").read())
        return (html.unescape(started[-1]) if started else "no test runs") + suffix


SHORT, LONG = "~*(long)*", "*(long)*"


def run_all(faults, chosen, build, record):
    limit, killed = {}, 0
    started = time.time()
    for room in ROOMS:
        numbers = [n for n in chosen if room_of(faults[n - 1]) == room]
        if not numbers:
            continue
        build.build(room) or build.give_up()
        begin = time.time()
        for tests in (SHORT, LONG):
            failed = build.run(room, tests, 3600)
            if failed:
                error(f"a test of {room} fails with the unchanged source: {failed}")
                sys.exit(1)
        limit[room] = 60 + 5 * (time.time() - begin)
        print(f"{room}: the tests pass with the unchanged source ({time.time() - begin:.0f} s)", flush=True)
        for n in numbers:
            f = faults[n - 1]
            path, begin = os.path.join(build.tree, f["file"]), time.time()
            original = read(path)
            try:
                write(path, original.replace(f["old"], f["new"]))
                if not build.build(room):
                    result, found = "does not build", None
                else:
                    found = build.run(room, SHORT, limit[room]) or build.run(room, LONG, limit[room])
                    result = "found by " + found if found else "SURVIVES"
            finally:
                write(path, original)
            killed += found is not None
            if record:
                f["killed_by"] = found.removesuffix(" (does not end)") if found else ""
                write(os.path.join(ROOT, LIST), as_text(faults))
            print(f"{n:3} {room}: {f['fault']}: {result} ({time.time() - begin:.0f} s)", flush=True)
    print(f"{len(chosen) - killed} of {len(chosen)} faults are not found ({(time.time() - started) / 60:.0f} min)")
    print(f"mutations, {len(chosen)}, {killed}")
    return killed >= LEAST * len(chosen)


def as_text(faults):
    return json.dumps(faults, indent=1, ensure_ascii=False) + "\n"


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("number", type=int, nargs="*", help="numbers of faults, counted from 1")
    p.add_argument("--room", action="append", default=[], choices=ROOMS, help="all faults of a room")
    p.add_argument("--check", action="store_true", help="check the list and the page, build nothing")
    p.add_argument("--write", action="store_true", help="write tests/mutations.md, build nothing")
    p.add_argument("--record", action="store_true", help="store the tests that were found in the list")
    p.add_argument("--work", default=os.path.join(ROOT, "build", "mutations"), metavar="DIRECTORY",
                   help="for the copy of the tree and its build (default: build/mutations)")
    p.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N", help="compilers at a time")
    a = p.parse_args()
    faults = json.loads(read(os.path.join(ROOT, LIST)))
    if a.write:
        write(os.path.join(ROOT, PAGE), page(faults))
        return 0
    if a.check:
        return 0 if check(faults) else 1
    wrong = [n for n in a.number if not 1 <= n <= len(faults)]
    if wrong:
        p.error(f"a number must be from 1 to {len(faults)}, got {wrong[0]}")
    chosen = [n for n in range(1, len(faults) + 1)
              if n in a.number or room_of(faults[n - 1]) in a.room or not (a.number or a.room)]
    good = run_all(faults, chosen, Build(os.path.realpath(a.work), a.jobs), a.record)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
