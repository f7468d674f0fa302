"""Calibrates avalanche friction laws in a Bayesian way, and finds the physics
that they leave out.

    >>> import couloir
    >>> found = couloir.diagnose(quick=True, quiet=True)
    >>> found.verdict, found.selected
    ('missing-physics', ['turbulent-drag'])

`calibrate`, `diagnose`, `simulate`, `sweep` and `import_log` do what the command's
words of these names do, with the same results for the same seed.
"""

from couloir._couloir import InputError
from couloir.calibration import Calibration, Checks, Evidence, calibrate
from couloir.diagnosis import (
    Diagnosis,
    Improvement,
    Mechanism,
    Mismatch,
    Noise,
    Rival,
    Withheld,
    diagnose,
)
from couloir.event import Event
from couloir.imported import Imported, import_log
from couloir.many import Sweep, sweep
from couloir.parameter import Parameter
from couloir.result import Draws, Figure
from couloir.simulation import Simulation, simulate

__all__ = [
    "Calibration",
    "Checks",
    "Diagnosis",
    "Draws",
    "Event",
    "Evidence",
    "Figure",
    "Imported",
    "Improvement",
    "InputError",
    "Mechanism",
    "Mismatch",
    "Noise",
    "Parameter",
    "Rival",
    "Simulation",
    "Sweep",
    "Withheld",
    "calibrate",
    "diagnose",
    "import_log",
    "simulate",
    "sweep",
]
