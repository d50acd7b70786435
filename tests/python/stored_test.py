# SPDX-License-Identifier: GPL-3.0-or-later
"""Results in folders, and co-simulations, against the files of the program."""

import csv
import os
import signal
import subprocess
import tempfile
import threading
import unittest

import numpy as np

import hilda

PROGRAM = os.environ["HILDA_PROGRAM"]
EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples")
STRIKE = os.path.join(EXAMPLES, "cosim", "strike", "strike.json")


def hilda_program(*words):
    subprocess.run([PROGRAM, *words], check=True, capture_output=True)


class Stored(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)

    def path(self, name):
        return os.path.join(self.temporary.name, name)

    def test_a_run(self):
        expected = hilda.run("slider_crank", "rA-half-1", step=1e-3, end=0.3, interval=0.01)
        for format in ("csv", "hdf5"):
            folder = self.path(format)
            hilda_program("run", "slider_crank", "--integrator", "rA-half-1", "--step", "1e-3", "--end", "0.3", "--interval", "0.01",
                          "--format", format, "--output", folder)
            stored = hilda.load(folder)
            self.assertEqual(stored.bodies, expected.bodies)
            for name in ("t", "r", "rdot", "rddot", "A", "omega_bar", "omegadot_bar", "energy"):
                np.testing.assert_array_equal(getattr(stored, name), getattr(expected, name), err_msg=name)
            np.testing.assert_array_equal(stored["slider"].r, expected["slider"].r)
            self.assertEqual(stored.summary["status"], "ok")
            self.assertEqual(stored.model["name"], "slider_crank")
            self.assertIn("trajectory", repr(stored))
            np.testing.assert_array_equal(hilda.Model(stored.model).start.r, expected.r[0])

    def test_a_granular_run(self):
        folder = self.path("grains")
        hilda_program("granular", os.path.join(EXAMPLES, "cases", "dumb_bell.json"), "--end", "0.002", "--output", folder)
        stored = hilda.load(folder)
        self.assertEqual((stored.bodies, stored.r.shape[1:]), ([], (0, 3)))
        with open(os.path.join(folder, "run.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        for name in rows[0]:
            np.testing.assert_array_equal(stored.tables["run"][name], [float(row[name] or "nan") for row in rows])

    def test_refusals(self):
        with self.assertRaisesRegex(hilda.FileError, "none: is not a directory"):
            hilda.load(self.path("none"))
        with self.assertRaisesRegex(hilda.InvalidInput, "it is no result of a run"):
            hilda.load(self.temporary.name)
        for text, message in (("t,x\n0\n", "trajectory.csv: "), ("t,bar.rx\n0,1\n", "no column bar.ry"), ("t,bar.rx\n0,what\n", "what"),
                              ("", "has no header"), ("x\n1\n", "trajectory has no column t")):
            with open(self.path("trajectory.csv"), "w", encoding="utf-8") as file:
                file.write(text)
            with self.subTest(text), self.assertRaisesRegex(hilda.InvalidInput, message):
                hilda.load(self.temporary.name)

    def test_a_co_simulation_is_that_of_the_program(self):
        hilda_program("cosim", STRIKE, "--end", "0.01", "--reactions", "--output", self.path("a"))
        result = hilda.cosim(STRIKE, self.path("b"), end=0.01, reactions=True)
        a = hilda.load(self.path("a"))
        np.testing.assert_array_equal(result.r, a.r)
        for name, values in a.grains.tables["run"].items():
            np.testing.assert_array_equal(result.grains.tables["run"][name], values, err_msg=name)
        self.assertEqual(result.bodies, ["ball"])
        longer = hilda.cosim(STRIKE, self.path("b"), end=0.02, reactions=True, resume=True)
        self.assertAlmostEqual(longer.t[-1], 0.02)
        np.testing.assert_array_equal(longer.r[:len(result)], result.r)
        with self.assertRaisesRegex(hilda.UsageError, "b: .*not empty"):
            hilda.cosim(STRIKE, self.path("b"))
        for keys, text in (({"threads": 0}, "from 1 to 1024, got 0"), ({"end": -1}, "end must be finite and not negative"),
                           ({"force": True, "resume": True}, "exclude each other")):
            with self.assertRaisesRegex(hilda.UsageError, text):
                hilda.cosim(STRIKE, self.path("c"), **keys)
        with self.assertRaisesRegex(hilda.UsageError, "path of a folder, got an empty text"):
            hilda.cosim(STRIKE, "")
        with self.assertRaisesRegex((hilda.InvalidInput, hilda.FileError), "none.json"):
            hilda.cosim(self.path("none.json"), self.path("c"))
        with self.assertRaisesRegex(hilda.InvalidInput, "nothing"):
            hilda.cosim(STRIKE, self.path("c"), set={"/nothing/0": 1})

    def test_one_co_simulation_at_a_time(self):
        started = threading.Thread(target=hilda.cosim, args=(STRIKE, self.path("a")), kwargs={"end": 0.05})
        started.start()
        while not os.path.isdir(self.path("a")):
            pass
        with self.assertRaisesRegex(hilda.UsageError, "another thread runs a co-simulation"):
            hilda.cosim(STRIKE, self.path("b"))
        started.join()
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)
        self.assertAlmostEqual(hilda.load(self.path("a")).t[-1], 0.05)

    def test_an_interrupted_co_simulation_continues(self):
        timer = threading.Timer(0.7, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            hilda.cosim(STRIKE, self.path("a"), end=100)
        timer.join()
        reached = hilda.load(self.path("a")).t[-1]
        self.assertGreater(reached, 0)
        result = hilda.cosim(STRIKE, self.path("a"), end=reached + 0.002, resume=True)
        self.assertGreater(result.t[-1], reached)


if __name__ == "__main__":
    unittest.main()
