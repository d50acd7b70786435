# SPDX-License-Identifier: GPL-3.0-or-later
"""Granular flows: spheres, boundaries and contact laws (the discrete element method).

    import hilda_granular
    world = hilda_granular.World("bed", threads=2)
    world.step(1000)
    print(world.t, world.r.mean(axis=0))
"""

from . import errors, loading  # before the extension module
from ._granular import __version__
from .boundary import Boundary
from .errors import Error, FileError, InvalidInput, NotAvailable, NumericalFailure, UsageError
from .results import Contacts, Removed, Totals
from .world import World, cases, run

__all__ = ["Boundary", "Contacts", "Error", "FileError", "InvalidInput", "NotAvailable", "NumericalFailure", "Removed", "Totals",
           "UsageError", "World", "__version__", "cases", "errors", "run"]
