#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An option that a scheme declares, --damping of demo-kick, is a keyword of Model.run().

    python_test.py LIBRARY      LIBRARY: the scheme, a shared library
"""
import ctypes
import os
import sys
import unittest

library = sys.argv.pop()
sys.setdlopenflags(os.RTLD_NOW | os.RTLD_GLOBAL)  # the library uses the functions of the extension module
import hilda  # noqa: E402
from hilda import _hilda  # noqa: E402


class OptionOfAScheme(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.before = _hilda.setting_is_switch()
        ctypes.CDLL(library)

    def test_names(self):
        self.assertEqual(_hilda.setting_is_switch(), {**self.before, "damping": False})
        self.assertEqual(hilda.integrators()["demo-kick"]["options"], ["--damping"])

    def test_the_keyword(self):
        def energy_lost(**settings):
            result = hilda.run("double_pendulum", "demo-kick", end=0.2, **settings)
            return result.energy[0] - result.energy[-1]

        self.assertEqual(energy_lost(damping=0), energy_lost())
        with self.assertWarnsRegex(hilda.SimulationWarning, "nothing in the model dissipates energy"):
            damped = energy_lost(damping=3)
        self.assertGreater(damped, 10 * abs(energy_lost()))

    def test_errors(self):
        for keys, text in (({"damping": -1, "integrator": "demo-kick"}, "--damping: must be a finite number, not negative, got '-1'"),
                           ({"damping": 3}, "run: no selected integrator uses --damping; it is for demo-kick"),
                           ({"dampink": 3}, "run: unknown keyword 'dampink'; did you mean 'damping'")):
            with self.subTest(**keys), self.assertRaisesRegex(hilda.UsageError, text):
                hilda.run("double_pendulum", **keys)


if __name__ == "__main__":
    unittest.main()
