# SPDX-License-Identifier: GPL-3.0-or-later
"""A run is checked alike however it is started: the program, Python, a study, a reference solution, a sweep and a fit report the
same findings, and refuse the same step. tests/running/simulation_test.cpp has the same for C++."""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

import hilda

PROGRAM = os.environ["HILDA_PROGRAM"]

# 1 kg on a spring of 1e6 N/m: the stability limit is 2e-3 s
SPRING = {"hilda_model": 1, "name": "spring", "end": 0.1, "gravity": [0, 0, 0],
          "bodies": [{"name": "mass", "mass": 1, "inertia": [1, 1, 1], "r": [1.01, 0, 0]}],
          "forces": [{"type": "spring-damper", "name": "s", "body_i": "ground", "body_j": "mass", "stiffness": 1e6, "free_length": 1}]}
# 0.301 rad in a step of 1e-3 s
ROTOR = {"hilda_model": 1, "name": "rotor", "end": 0.1, "gravity": [0, 0, 0],
         "bodies": [{"name": "rotor", "mass": 1, "inertia": [1, 2, 2.5], "r": [0, 0, 0], "omega": [301, 0, 0]}]}
# A tippe top: the deflection of the friction spring turns faster than the contact point slides.
TOP = {"hilda_model": 1, "name": "top", "end": 0.01,
       "bodies": [{"name": "top", "mass": 0.006, "inertia": [5.4e-7, 5.4e-7, 5.4e-7], "r": [0, 0, 0.015], "r_dot": [0.045, 0, 0],
                   "omega": [0, 0, 150]}],
       "contacts": [{"name": "top-table", "body_i": "top", "body_j": "ground", "surface_i": {"type": "sphere", "radius": 0.015},
                     "surface_j": {"type": "plane"}, "normal": {"type": "constraint"},
                     "friction": {"law": "implicit", "mu_s": 0.3, "mu_k": 0.3, "K_E": 200}}]}


def without_numbers(text):
    return re.sub(r"[0-9.]+(e[+-]?[0-9]+)?", "N", text)


class EntryPoints(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        for model in (SPRING, ROTOR, TOP):
            with open(f"{self.folder}/{model['name']}.json", "w", encoding="utf-8") as file:
                json.dump(model, file)

    def call(self, *words):
        return subprocess.run([PROGRAM, *words], cwd=self.folder, check=False, capture_output=True, text=True)

    def results(self, output, name):
        with open(f"{self.folder}/{output}/{name}", encoding="utf-8") as file:
            return json.load(file)

    def findings_of_study(self, output):
        """NAME: TEXT of all runs, without the names"""
        return [line.split(": ", 1)[1] for run in self.results(output, "study.json")["runs"] for line in run.get("warnings", [])]

    def check_found(self, model, integrator, step, finding):
        """Each entry point reports the finding of `hilda run`, which contains this text, of 300 steps without rows, as in a study."""
        end = round(300 * step, 9)
        options = ("--integrator", integrator, "--end", str(end))
        ended = self.call("run", model, *options, "--step", str(step), "--interval", str(end), "--output", "run")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        (of_run,) = self.results("run", "summary.json")["model"]["warnings"]
        self.assertIn(finding, of_run)
        self.assertIn(of_run, ended.stderr)

        path = model if model == "double_pendulum" else f"{self.folder}/{model}"
        with self.assertWarns(hilda.SimulationWarning) as warned:
            result = hilda.run(path, integrator, step=step, end=end, interval=end)
        self.assertEqual(str(warned.warning), of_run)
        self.assertEqual((result.status, result.warnings), ("ok", [of_run]))

        ended = self.call("study", "compare", "--problem", model, *options, "--steps", str(step), "--no-plot", "--quiet", "--output", "study")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertEqual(self.findings_of_study("study"), [of_run])

        # the step of the runs and of the reference is the same: --accept-reference
        ended = self.call("study", "convergence", "--problem", model, *options, "--steps", f"{step}", "--reference", integrator,
                          "--reference-step", str(step), "--accept-reference", "--no-plot", "--output", "reference")
        of_reference = f"warning: the reference {integrator} of {model.removesuffix('.json')}: {of_run}"
        # A reference has a row at each instant: its energy is evaluated at more nodes.
        self.assertIn(without_numbers(of_reference), without_numbers(ended.stderr))

        ended = self.call("study", "sweep", model, "--sweep", "/end=1:2:2", *options, "--steps", str(step), "--no-plot", "--quiet",
                          "--output", "sweep")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertEqual(self.findings_of_study("sweep"), [of_run] * 2)

    def test_a_body_that_turns_too_far_in_a_step(self):
        self.check_found("rotor.json", "rA-half-1-momentum", 1e-3, "body 'rotor' turns by 0.301 rad in one step")

    def test_energy_that_drifts(self):
        self.check_found("double_pendulum", "rA-half-1", 1e-2, "the energy rises by")

    def test_friction_that_is_too_soft(self):
        self.check_found("top.json", "rA-half-1-momentum", 1e-4, "contact 'top-table': the friction spring is too soft")

    def test_a_fit_reports_them(self):
        # the lowest point of the second bar at two times, and an integrator whose energy drifts
        ended = self.call("fit", "double_pendulum", "--data", self.data("bar_2.rz"), "--parameter", "/bodies/1/mass=100",
                          "--integrator", "rA-half-1", "--step", "1e-2", "--no-plot", "--output", "fit", "--max-fit-iterations", "1")
        self.assertIn("the energy rises by", ended.stderr + ended.stdout)

    def data(self, column):
        with open(f"{self.folder}/data.csv", "w", encoding="utf-8") as file:
            file.write(f"t,{column}\n1.5,-1\n3,-1\n")
        return "data.csv"

    def test_an_unstable_step(self):
        found = "the step 0.0025 s is above 0.001999 s, the stability limit of force 's' in an explicit step"
        step = ("--integrator", "rA-half-1-momentum", "--step", "2.5e-3")
        fit = ("--data", self.data("mass.rx"), "--parameter", "/bodies/0/mass=1")
        # --reference: runs with a smaller step than the reference, which --accept-reference would accept
        reference = ("--problem", "spring.json", "--integrator", "rA-half-1-momentum", "--steps", "2.5e-2", "--end", "0.1",
                     "--reference", "rA-half-1-momentum", "--reference-step", "2.5e-3")
        for words in (("run", "spring.json", *step), ("fit", "spring.json", *fit, *step), ("study", "compare", *reference)):
            ended = self.call(*words, "--no-plot", "--output", "refused")
            self.assertEqual(ended.returncode, 2, f"{words}: {ended.stderr}")
            self.assertIn(found, ended.stderr)
        with self.assertRaisesRegex(hilda.UsageError, found):
            hilda.run(f"{self.folder}/spring.json", "rA-half-1-momentum", step=2.5e-3)
        # A study has the run in its table, with the finding.
        ended = self.call("study", "compare", "--problem", "spring.json", "--integrator", "rA-half-1-momentum", "--steps", "2.5e-3",
                          "--no-plot", "--quiet", "--output", "study")
        self.assertTrue(any("the stability limit of force 's'" in line for line in self.findings_of_study("study")))


if __name__ == "__main__":
    sys.exit(unittest.main())
