"""The native part: JSON text in, JSON text out. `armwright` has the functions for people."""

from os import PathLike
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union, final

_Source = Tuple[str, Optional[str]]
_Path = Union[str, PathLike[str]]
_Table = Tuple[List[str], List[List[str]]]

__version__: str

@final
class Catalogs:
    """Gears, motors, materials and profiles, read once and used by any number of calls."""

    @staticmethod
    def builtin() -> Catalogs:
        """The catalogs that come with armwright."""
    @staticmethod
    def load(folder: _Path) -> Catalogs:
        """The built-in catalogs with the rows of gears.csv, motors.csv, materials.csv and profiles.csv in a folder laid over
        them. A row of the same name replaces the built-in one.

        Raises CatalogError with every fault of the rows, or FileError."""
    @property
    def folder(self) -> Optional[Path]:
        """The folder that was laid over the built-in rows; None if there is none. A copy for another process reads it again."""
    @property
    def gears(self) -> List[str]:
        """Names of the gears."""
    @property
    def motors(self) -> List[str]:
        """Names of the motors."""
    @property
    def materials(self) -> List[str]:
        """Names of the materials."""

def analyze(
    catalogs: Catalogs,
    arm: _Source,
    cases: _Source,
    modes: int,
    harmonic: Optional[Tuple[Sequence[float], float, Sequence[float]]],
) -> Tuple[str, List[str], List[str]]: ...
def driven_joints(catalogs: Catalogs, arm: _Source) -> List[str]: ...
def size(catalogs: Catalogs, study: _Source, design: Optional[str]) -> Tuple[str, List[str]]: ...
def capacity(
    catalogs: Catalogs, asked: _Source, design: Optional[str], cases: Optional[_Source], limits: Optional[_Source]
) -> str: ...
def design(catalogs: Catalogs, study: _Source, id: str) -> Tuple[str, str]: ...
def export(
    catalogs: Catalogs,
    arm: _Source,
    cases: _Source,
    to: str,
    case: Optional[str],
    pieces_per_link: Optional[int],
    backlash: bool,
) -> Tuple[str, List[Tuple[str, bytes]]]: ...
def from_urdf(catalogs: Catalogs, robot: _Source, tip: str, stiffness: Optional[_Source]) -> Tuple[str, str]: ...
def paper(catalogs: Catalogs, name: str) -> List[Tuple[str, str]]: ...
def study_names() -> List[str]: ...
def study_text(name: str) -> Optional[str]: ...
def run(
    catalogs: Catalogs,
    study: _Source,
    effects: Optional[_Source],
    method: Optional[str],
    gap_percent: Optional[float],
    time_limit_s: Optional[float],
    within: Optional[Tuple[float, int]],
    scatter: Optional[Tuple[str, int, int]],
    threads: int,
    progress: Optional[Callable[[Dict[str, Any]], Any]],
) -> Tuple[_Table, List[Tuple[str, _Table]], Tuple[Optional[str], Optional[str]], str, str]: ...
def reconcile(catalogs: Catalogs, campaigns: Sequence[_Path]) -> Tuple[str, str, str, str, List[Tuple[str, str]]]: ...
def predict(
    catalogs: Catalogs, arm: _Path, readings: _Path, campaign: _Path
) -> Tuple[str, Optional[str]]: ...
