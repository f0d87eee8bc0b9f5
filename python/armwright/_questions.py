"""The questions of the program as functions. Numbers are those of its JSON output, to the last digit."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

from . import _armwright
from ._armwright import Catalogs
from ._input import catalogs_or_builtin, source
from .errors import FileError
from .table import Prediction, Table

PathLike = Union[str, "os.PathLike[str]"]
#: An arm or a study: a path, a dict with the keys of its file, or the JSON text. A study may be a built-in one's name.
Described = Union[PathLike, Mapping]
Vector = Sequence[float]


def driven_joints(arm: Described, *, catalogs: Optional[Catalogs] = None) -> List[str]:
    """Names of the driven joints of an arm, base to tip: the order of the angles of a pose."""
    return _armwright.driven_joints(catalogs_or_builtin(catalogs), source(arm, "arm"))


def analyze(
    arm: Described,
    pose: Union[None, Vector, Mapping] = None,
    *,
    cases: Union[None, PathLike, Sequence[Mapping]] = None,
    payload_kg: float = 0.0,
    payload_cg_m: Vector = (0.0, 0.0, 0.0),
    payload_inertia_kgm2: Vector = (0.0, 0.0, 0.0),
    force_n: Vector = (0.0, 0.0, 0.0),
    moment_nm: Vector = (0.0, 0.0, 0.0),
    links: str = "full",
    joints: str = "three_segment",
    modes: int = 6,
    response_n: Optional[Vector] = None,
    response_hz: Vector = (),
    damping: float = 0.02,
    catalogs: Optional[Catalogs] = None,
) -> Any:
    """Statics, modes and response of an arm, as ``armwright analyze --json`` prints them.

    One pose and load, or ``cases``: a file or a list with the keys of a cases file. With ``cases`` the answer is a list.

    :param arm: path, dict or JSON text of an arm file
    :param pose: one angle a driven joint, base to tip [deg]; or a mapping with the keys that ``pose`` has in a cases file.
        All zero if it is left out.
    :param payload_kg: payload mass [kg]
    :param payload_cg_m: its centre of gravity from the tip, in the last frame [m]
    :param payload_inertia_kgm2: its moments of inertia about its centre [kg m²]
    :param force_n: force at the tip, world axes [N]
    :param moment_nm: moment at the tip, world axes [N m]
    :param links: ``rigid``, ``bending`` (Eqs 1-6) or ``full``
    :param joints: ``k2``, ``three_segment`` or ``three_segment_k1``
    :param modes: how many modes
    :param response_n: amplitude of a harmonic force at the tip, world axes [N]; asks for the response at ``response_hz``
    :param response_hz: frequencies of the response [Hz]
    :param damping: damping ratio of every mode, for the response
    :returns: dict with ``joint_torque_nm`` [N m], ``tip_displacement_m`` [m], ``shares`` [m], ``modes`` [Hz] and others
        (docs/arm-format.md)
    :raises InputError: the arm or the cases are faulty
    """
    held = catalogs_or_builtin(catalogs)
    arm_source = source(arm, "arm")
    asked = cases
    if cases is None:
        case: Dict[str, Any] = {
            "name": "case",
            "payload": {"mass_kg": payload_kg, "cg_m": payload_cg_m, "inertia_about_cg_kgm2": payload_inertia_kgm2},
            "tip_force_n": force_n,
            "tip_moment_nm": moment_nm,
            "links": links,
            "joints": joints,
        }
        if isinstance(pose, Mapping):
            case["pose"] = pose
        else:
            case["pose_deg"] = [0.0] * len(_armwright.driven_joints(held, arm_source)) if pose is None else pose
        asked = [case]
    elif pose is not None:
        raise TypeError("give a pose or cases, not both")
    harmonic = None
    if response_n is not None:
        harmonic = ([float(x) for x in response_n], float(damping), [float(f) for f in response_hz])
    answers = json.loads(_armwright.analyze(held, arm_source, source(asked, "cases"), modes, harmonic))
    return answers[0] if cases is None else answers


def size(
    study: Described, *, design: Optional[str] = None, catalogs: Optional[Catalogs] = None
) -> List[Dict[str, Any]]:
    """The sizing of every joint of a study's arm, tip first, as ``armwright size --json`` prints it.

    :param study: name of a built-in study, path, dict or JSON text
    :param design: a ``design_id``; without it, links of median mass
    :returns: a dict a joint: demand [N m, rad/s], gear, motor, margin, the check that binds
    :raises EmptySpaceError: there is nothing to choose from
    :raises InfeasibleError: no drive holds at some joint
    """
    return json.loads(_armwright.size(catalogs_or_builtin(catalogs), source(study, "study"), design))


def capacity(
    study: Described, *, design: Optional[str] = None, catalogs: Optional[Catalogs] = None
) -> Dict[str, Any]:
    """The largest payload of a study's arm, as ``armwright capacity --json`` prints it.

    :returns: dict with ``payload_kg`` [kg] (None if nothing limits it), ``pose``, ``joint``, ``check``, and in ``table`` the same
        for every pose by itself, with its reach [m]
    :raises InfeasibleError: the drives do not hold the study's own payload
    """
    return json.loads(_armwright.capacity(catalogs_or_builtin(catalogs), source(study, "study"), design))


def design(
    study: Described, design_id: str, *, catalogs: Optional[Catalogs] = None
) -> Tuple[Dict[str, Any], List[Dict[str, Any]]]:
    """A design of a study as an arm file with every part resolved to numbers, and the cases in which it is judged."""
    arm, cases = _armwright.design(catalogs_or_builtin(catalogs), source(study, "study"), design_id)
    return json.loads(arm), json.loads(cases)


def from_urdf(
    file: PathLike,
    tip: str,
    *,
    stiffness: Union[None, PathLike, Mapping] = None,
    catalogs: Optional[Catalogs] = None,
) -> Dict[str, Any]:
    """An arm file, as a dict, of the joints and links of a URDF file from its root to a link, as ``armwright import`` writes it.

    :param file: path of the URDF file, or its text
    :param tip: link where the arm ends
    :param stiffness: stiffness of each joint by its name [N m/rad], or a mapping of its keys in arm files; or the path of a
        stiffness file (docs/interchange.md). A joint without one is rigid.
    :returns: dict for :func:`analyze`; ``provenance`` has what ``import.json`` says of what was lumped and left rigid
    :raises InputError: every fault of the URDF, or of the stiffness
    """
    given = None
    if isinstance(stiffness, Mapping):
        keys = lambda value: value if isinstance(value, Mapping) else {"stiffness_nm_per_rad": value}
        given = source({"joints": {joint: keys(value) for joint, value in stiffness.items()}}, "stiffness")
    elif stiffness is not None:
        given = source(stiffness, "stiffness")
    is_text = isinstance(file, str) and file.lstrip().startswith("<")
    try:
        text = str(file) if is_text else Path(file).read_text(encoding="utf-8")
    except OSError as reason:
        raise FileError(f"cannot read {os.fspath(file)}: {reason.strerror}") from None
    name = "urdf" if is_text else os.fspath(file)
    arm, report = _armwright.from_urdf(catalogs_or_builtin(catalogs), name, text, tip, given)
    return {**json.loads(arm), "provenance": json.loads(report)}


def studies() -> List[str]:
    """Names of the built-in studies, those of the paper included."""
    return _armwright.study_names()


def study(name: str) -> Dict[str, Any]:
    """The file of a built-in study, to be changed and given to :func:`run`."""
    text = _armwright.study_text(name)
    if text is None:
        raise KeyError(f"{name!r} has no study file; known: {', '.join(studies())}")
    return json.loads(text)


def paper(name: str = "paper-table1", *, catalogs: Optional[Catalogs] = None) -> Dict[str, Union[str, Table]]:
    """The files of a study of the paper: tables by the names of their CSV files, and pictures as SVG text."""
    files = _armwright.paper(catalogs_or_builtin(catalogs), name)
    return {name: Table.from_csv(text) if name.endswith(".csv") else text for name, text in files}


class Outcome:
    """What :func:`reconcile` found."""

    verdict: str
    """``no_gap``, ``explained``, ``unexplained`` or ``insufficient_data``."""
    json: Dict[str, Any]
    """The verdict with its evidence, by the keys of ``verdict.json`` (docs/reconcile.md)."""
    text: str
    """The verdict in words, as ``armwright reconcile`` prints it."""
    corrected_arm: Dict[str, Any]
    """The arm with what was calibrated and found, for :func:`analyze` and :func:`predict`."""
    residuals: Table
    """Every reading with the nominal and the corrected model's residual."""

    def __init__(self, found: Tuple[str, str, str, str, List[Tuple[str, str]]]):
        verdict, self.text, arm, residuals, self._files = found
        self.json = json.loads(verdict)
        self.verdict = self.json["verdict"]
        self.corrected_arm = json.loads(arm)
        self.residuals = Table.from_csv(residuals)

    def write(self, folder: PathLike) -> List[Path]:
        """Writes verdict.json, verdict.txt, arm.corrected.json and residuals.csv; returns their paths."""
        Path(folder).mkdir(parents=True, exist_ok=True)
        paths = [Path(folder) / name for name, _ in self._files]
        for path, (_, text) in zip(paths, self._files):
            path.write_bytes(text.encode("utf-8"))
        return paths

    def __repr__(self) -> str:
        return f"<armwright.Outcome: {self.verdict}>"


def reconcile(*campaigns: PathLike, catalogs: Optional[Catalogs] = None) -> Outcome:
    """Where an arm and its measurements disagree, and which effect is missing.

    The interpreter's lock is free while it works. After Ctrl-C the call ends at once; the fit that was begun runs to its end on its
    own thread and is forgotten.

    :param campaigns: folders with campaign.json, arm.json and readings; several of one arm are reconciled together
    :raises InputError: every fault of the files
    """
    folders = [os.fspath(folder) for folder in campaigns]
    return Outcome(_armwright.reconcile(catalogs_or_builtin(catalogs), folders))


def predict(
    arm: PathLike, readings: PathLike, campaign: PathLike, *, catalogs: Optional[Catalogs] = None
) -> Prediction:
    """Readings with the model's value added to each, as ``armwright predict`` writes them.

    :param arm: path of an arm file, corrected or not
    :param readings: path of a file of static, modal, windup or positions readings
    :param campaign: path of the campaign.json that says how they were taken
    :returns: the table of the readings with columns such as ``model_dz_mm`` [mm] or ``model_frequency_hz`` [Hz]
    """
    held = catalogs_or_builtin(catalogs)
    text, remark = _armwright.predict(held, os.fspath(arm), os.fspath(readings), os.fspath(campaign))
    out = Prediction.from_csv(text)
    out.remark = remark
    return out
