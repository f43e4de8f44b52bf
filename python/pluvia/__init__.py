"""Granular soil as rigid convex polyhedra: pour it, shake it and measure it.

>>> import pluvia
>>> run = pluvia.run(pluvia.example("quick/pluviation"), out="out/first")  # doctest: +SKIP
>>> run["void_ratio"]  # doctest: +SKIP

`run` simulates a scenario, `load` opens a folder of results, `sweep` and `calibrate` run many. Tables are pandas
frames with the units in the names of their columns; arrays of positions and hulls are in metres.
"""

from ._command import Progress, info, schema
from ._errors import Error, FileError, NotValidWarning, ScenarioError, ScenarioWarning, SimulationError
from ._pluvia import __version__
from ._run import Run, load, run
from ._scenario import Scenario, example, examples
from ._specimen import Specimen
from ._study import Calibration, Sweep, calibrate, load_calibration, load_sweep, sweep
from ._view import View

__all__ = [
    "Calibration",
    "Error",
    "FileError",
    "NotValidWarning",
    "Progress",
    "Run",
    "Scenario",
    "ScenarioError",
    "ScenarioWarning",
    "SimulationError",
    "Specimen",
    "Sweep",
    "View",
    "__version__",
    "calibrate",
    "example",
    "examples",
    "info",
    "load",
    "load_calibration",
    "load_sweep",
    "run",
    "schema",
    "sweep",
]
