# SPDX-License-Identifier: GPL-3.0-or-later
"""Multibody dynamics with friction and contact, on rotation matrices.

    import hilda
    result = hilda.run("double_pendulum", "rA-dop853", rtol=1e-9)
    result.plot()
"""

from . import errors, so3  # before the extension module, which raises them
from ._hilda import Saddle, State, System, __version__
from .cosimulation import cosim
from .errors import Error, FileError, InvalidInput, NotAvailable, NumericalFailure, SimulationWarning, UsageError
from .fitting import Fit, fit
from .integrator import Integrator
from .model import Model, integrators, problems, run
from .orders import Convergence, convergence
from .parameters import Sweep, sweep
from .result import BodyResult, Events, Result
from .simulation import Simulation
from .stored import StoredResult, load
from .surface import Surface
from .work import WorkPrecision, work_precision

__all__ = ["BodyResult", "Convergence", "Error", "Events", "FileError", "Fit", "Integrator", "InvalidInput", "Model",
           "NotAvailable", "NumericalFailure", "Result", "Saddle", "Simulation", "SimulationWarning", "State", "StoredResult",
           "Surface", "Sweep", "System", "UsageError", "WorkPrecision", "__version__", "convergence", "cosim", "errors", "fit",
           "integrators", "load", "problems", "run", "so3", "sweep", "work_precision"]
