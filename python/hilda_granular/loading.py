# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads the extension module with threads of OpenMP that sleep while they wait.

By default the OpenMP runtime of GCC lets waiting threads spin for milliseconds, which takes the time of working threads on a
machine whose cores are busy. The runtime reads its settings when it is loaded. GOMP_SPINCOUNT and OMP_WAIT_POLICY have precedence.
"""

import importlib
import os

_SPINS = "3000"  # of about 10 ns, as in the program; the default is 300000


def _load() -> None:
    if {"GOMP_SPINCOUNT", "OMP_WAIT_POLICY"} & os.environ.keys():
        return
    os.environ["GOMP_SPINCOUNT"] = _SPINS
    try:
        importlib.import_module("hilda_granular._granular")
    finally:
        del os.environ["GOMP_SPINCOUNT"]  # other programs have their own settings


_load()
