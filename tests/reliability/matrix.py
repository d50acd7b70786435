# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rows of the reliability matrix have in common.

A row is a script. It prints one line for each case that fails, and at its end one line `NUMBER NAME, CASES, PASSED`.
Its exit code is 0 if all cases have passed. --build is the folder of the programs under test, by default build/release.
"""
import argparse
import contextlib
import math
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]


class Ended:
    def __init__(self, code, out, err, seconds, bytes_used):
        self.code, self.out, self.err, self.seconds, self.bytes = code, out, err, seconds, bytes_used

    def last_error(self):
        return self.err.strip().split("\n")[-1]


class Row:
    """The cases of one row. `options`: function that adds options to the parser of the command line"""

    def __init__(self, name, options=None):
        parser = argparse.ArgumentParser(description=sys.modules["__main__"].__doc__,
                                         formatter_class=argparse.RawDescriptionHelpFormatter)
        parser.add_argument("--build", default=str(SOURCE / "build/release"),
                            help="folder of the programs; default: build/release")
        if options:
            options(parser)
        self.options = parser.parse_args()
        self.name, self.cases, self.passed = name, 0, 0
        self.build = pathlib.Path(self.options.build).resolve()
        self.hilda, self.granular = str(self.build / "hilda"), str(self.build / "hilda-granular")
        self.environment = dict(os.environ, OMP_WAIT_POLICY="passive", UBSAN_OPTIONS="print_stacktrace=1")
        for variable in ("HILDA_END_AT", "OMP_NUM_THREADS"):
            self.environment.pop(variable, None)

    def case(self, what, passed, why=""):
        self.cases += 1
        self.passed += bool(passed)
        if not passed:
            print(f"failed: {what}: {why}".replace("\n", " | ")[:600], flush=True)

    def end(self):
        print(f"{self.name}, {self.cases}, {self.passed}", flush=True)
        sys.exit(0 if self.cases == self.passed and self.cases > 0 else 1)

    def run(self, command, *, cwd=None, limit=120, text=True, **options):
        """Runs a command with a time limit [s]. The exit code is -N after signal N. Its seconds are processor time."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        with subprocess.Popen([str(word) for word in command], cwd=cwd, env=options.pop("env", self.environment),
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=text, **options) as process:
            try:
                out, err = process.communicate(timeout=limit)
            except subprocess.TimeoutExpired:
                process.kill()
                out, err = process.communicate()
                err = f"no end within {limit} s: {err}"
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            return Ended(process.returncode, out, err, seconds, after.ru_maxrss * 1024)

    def killed_after(self, command, seconds, cwd=None):
        """Runs a command and kills it after a time. True if it was killed before its end"""
        process = subprocess.Popen([str(word) for word in command], cwd=cwd, env=self.environment,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            process.wait(seconds)
            return False
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.wait()
            return True


@contextlib.contextmanager
def scratch(where=None):
    """A temporary folder, removed at the end"""
    with tempfile.TemporaryDirectory(prefix="hilda-reliability-", dir=where) as folder:
        yield pathlib.Path(folder)


TABLES = ("trajectory.csv", "reactions.csv", "contacts.csv", "run.csv", "particles.csv", "outputs.csv", "forces.csv")


def tables(folder):
    """The bytes of the tables of a run, by name"""
    return {name: (folder / name).read_bytes() for name in TABLES if (folder / name).exists()}


def bad_values(file):
    """Number of values of a CSV file that are not finite"""
    count = 0
    with open(file) as lines:
        next(lines, None)
        for line in lines:
            for cell in line.split(","):
                try:
                    count += not math.isfinite(float(cell))
                except ValueError:
                    pass
    return count


def is_one_line(err, start="hilda: error"):
    lines = [line for line in err.strip().split("\n") if line]
    return len(lines) == 1 and lines[0].startswith(start)


def now():
    return time.monotonic()
