# SPDX-License-Identifier: GPL-3.0-or-later
"""A granular case and its runs by hilda-granular, for the tests of the program."""
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

# Polydisperse particles in a shaken cup under a free lid, with all laws that have a history.
CASE = {
    "hilda_case": 1, "name": "cup",
    "domain": {"low": [-0.002, -0.002, -0.002], "high": [0.022, 0.022, 0.08]},
    "step": 5e-6, "end": 0.2, "interval": 1e-2, "frame_interval": 1.5e-2,
    "orientation": True,
    "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24},
                  {"name": "steel", "density": 7800, "E": 2e8, "nu": 0.3}],
    "laws": [{"between": ["glass", "glass"], "restitution": 0.7, "mu": 0.3, "tangential": {"law": "mindlin"},
              "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}, "spin": {"law": "torsional-spring"}},
             {"between": ["glass", "steel"], "restitution": 0.5, "mu": 0.4, "tangential": {"law": "mindlin"},
              "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}}],
    "boundaries": [{"name": "floor", "type": "plane", "normal": [0, 0, 1], "r": [0, 0, "1e-4*sin(2*pi*40*t)"],
                    "material": "steel"},
                   {"name": "wall", "type": "cylinder", "r": [0.01, 0.01, 0], "axis": [0, 0, 1], "radius": 0.01,
                    "inside": True, "omega": [0, 0, "5*t"], "material": "steel"},
                   {"name": "lid", "type": "plane", "normal": [0, 0, -1], "r": [0, 0, 0.04], "mass": 2e-3,
                    "F": [0, 0, "-0.1*t"], "free": [False, False, True], "material": "steel"}],
    "fill": [{"type": "lattice", "low": [0.003, 0.003, 0], "high": [0.017, 0.017, 0.03], "radius": 1e-3,
              "least_radius": 6e-4, "spacing": 1.02, "jitter": 1, "random_v": 0.2, "material": "glass"}]}

# Particles attached to the shaken floor and to the rotating wall, below those of CASE
ATTACHED = {"particles": [{"r": [0.006 + 0.004 * k, 0.01, 5e-4], "radius": 6e-4, "material": "glass", "attached_to": name}
                          for k, name in ((0, "floor"), (1, "wall"), (2, "wall"))],
            "fill": [dict(CASE["fill"][0], low=[0.003, 0.003, 0.002])]}


class Runs:
    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)
        self.environment = dict(os.environ, OMP_WAIT_POLICY="passive")

    def case(self, name, **changes):
        (self.folder / f"{name}.json").write_text(json.dumps(dict(CASE, **changes)))
        return name

    def start(self, name, *arguments, program=None):
        threads = () if "--threads" in arguments else ("--threads", "1")
        return subprocess.Popen([program or self.program, f"{name}.json", "--contacts", *threads, *arguments], cwd=self.folder,
                                env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def finish(self, name, *arguments, code=0, **options):
        process = self.start(name, *arguments, **options)
        _, err = process.communicate()
        if process.returncode != code:
            sys.exit(f"{' '.join(process.args)}: ended with {process.returncode}, not {code}: {err}")
        return err

    def interrupt(self, name, output, checkpoints, which, *arguments):
        """Starts a run and sends it the signal after it has written this number of checkpoints.

        Returns whether the run was interrupted. A run that is complete before must end with 0. The number of checkpoints, and
        not a time, decides: the runs are interrupted on fast and slow machines.
        """
        file = self.folder / output / "checkpoint"

        def written():
            try:
                status = file.stat()
                return status.st_ino, status.st_mtime_ns
            except FileNotFoundError:
                return None

        process = self.start(name, "--output", output, *arguments)
        last = written()
        while process.poll() is None and checkpoints > 0:
            time.sleep(5e-4)
            now = written()
            checkpoints -= now not in (None, last)
            last = now
        if checkpoints == 0:
            process.send_signal(which)
        _, err = process.communicate()
        was_interrupted = process.returncode == (130 if which == signal.SIGINT else -which)
        expect(was_interrupted or process.returncode == 0, f"{output}: ended with {process.returncode}: {err}")
        return was_interrupted

    def sha(self, output):
        """SHA-256 of all output that does not depend on wall time"""
        out = self.folder / output
        files = [file for pattern in ("*.csv", "*.pvd", "vtk/*") for file in sorted(out.glob(pattern))]
        whole = hashlib.sha256()
        for file in files:
            whole.update(file.name.encode() + b"\0" + file.read_bytes())
        summary = self.summary(output)
        whole.update(json.dumps({key: summary[key] for key in summary if key not in ("timing", "provenance")}).encode())
        return whole.hexdigest()

    def summary(self, output):
        return json.loads((self.folder / output / "summary.json").read_text())

    def run(self, *arguments, **options):
        """The ended process of the program with these arguments, in the folder of the cases"""
        pipe = subprocess.PIPE
        settings = dict(cwd=self.folder, stdout=pipe, stderr=pipe, text=True, env=self.environment)
        return subprocess.run([self.program, *arguments], check=False, **dict(settings, **options))

    def refused(self, name, code, message, *arguments, **options):
        """Checks that the run ends with the exit code and one line on stderr that matches the message"""
        err = self.finish(name, "--quiet", *arguments, code=code, **options)
        lines = err.strip().split("\n")
        expect(len(lines) == 1 and re.search(f"^hilda: error.*{message}", lines[0]), f"{message} in one line: {err}")

    def remove(self, output):
        shutil.rmtree(self.folder / output, ignore_errors=True)


def expect(condition, what):
    if not condition:
        sys.exit(f"failed: {what}")
