"""Armwright sizes high-precision robot arms, finds their Pareto-optimal designs, and reconciles them with measurements.

>>> import armwright
>>> lever = {"chain": [
...     {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
...     {"type": "link", "name": "l1", "vector_m": [1, 0, 0], "mass_kg": 2}]}
>>> round(armwright.analyze(lever)["joint_torque_nm"]["j1"], 6)
9.81

Quantities are SI with the unit in the name; angles of poses are in degrees. The formats of arms, studies and campaigns are those
of the program's files.
"""

from ._armwright import Catalogs, __version__
from ._export import Export, export
from ._front import Designs, Front
from ._mujoco import from_mujoco
from ._questions import (
    Analysis,
    Outcome,
    Sizing,
    analyze,
    capacity,
    design,
    driven_joints,
    from_urdf,
    paper,
    predict,
    reconcile,
    size,
    studies,
    study,
)
from ._run import Interrupted, run
from .errors import (
    ArmwrightError,
    CatalogError,
    EmptySpaceError,
    Fault,
    FileError,
    InfeasibleError,
    InputError,
    OutOfTimeError,
    UsageError,
)
from .table import Prediction, Table

__all__ = [
    "Analysis",
    "ArmwrightError",
    "CatalogError",
    "Catalogs",
    "Designs",
    "EmptySpaceError",
    "Export",
    "Fault",
    "FileError",
    "Front",
    "InfeasibleError",
    "InputError",
    "Interrupted",
    "OutOfTimeError",
    "Outcome",
    "Prediction",
    "Sizing",
    "Table",
    "UsageError",
    "__version__",
    "analyze",
    "capacity",
    "design",
    "driven_joints",
    "export",
    "from_mujoco",
    "from_urdf",
    "paper",
    "predict",
    "reconcile",
    "run",
    "size",
    "studies",
    "study",
]
