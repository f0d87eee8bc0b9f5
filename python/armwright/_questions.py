"""The questions of the program as functions. Numbers are those of its JSON output, to the last digit."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union, overload

import numpy as np

from . import _armwright
from ._armwright import Catalogs
from ._input import BLANK, catalogs_or_builtin, finite, path, source, vector, whole
from .errors import UsageError
from .table import Prediction, Table

PathLike = Union[str, "os.PathLike[str]"]
#: An arm or a study: a path, a dict with the keys of its file, or the JSON text. A study may be a built-in one's name.
Described = Union[PathLike, Mapping]
Vector = Union[Sequence[float], np.ndarray]

#: What is asked of a response where nothing else is said, as by the program [Hz].
_RESPONSE_HZ = [1.0 + (100.0 - 1.0) * i / 99.0 for i in range(100)]


class Analysis(dict):
    """The results of an arm in one case, by the keys of ``armwright analyze --json``."""

    text: str
    """The results in words, as ``armwright analyze`` prints them, with the mass of the arm and what counts as rigid or unknown."""
    remarks: List[str]
    """What a reader of the numbers should know, in sentences: what is left out of them, and materials that creep."""

    def __init__(self, results: Mapping, text: str, remarks: Sequence[str]):
        super().__init__(results)
        self.text, self.remarks = text, list(remarks)

    def __reduce__(self) -> Tuple[Any, ...]:
        return Analysis, (dict(self), self.text, self.remarks)


class Sizing(list):
    """The sizing of the joints of an arm, tip first: a dict a joint, by the keys of ``armwright size --json``."""

    remarks: List[str]
    """What a reader of the numbers should know, in sentences, as ``armwright size`` prints them below its tables."""

    def __init__(self, rows: Sequence[Dict[str, Any]], remarks: Sequence[str]):
        super().__init__(rows)
        self.remarks = list(remarks)

    def __reduce__(self) -> Tuple[Any, ...]:
        return Sizing, (list(self), self.remarks)


def driven_joints(arm: Described, *, catalogs: Optional[Catalogs] = None) -> List[str]:
    """Names of the driven joints of an arm, base to tip: the order of the angles of a pose."""
    return _armwright.driven_joints(catalogs_or_builtin(catalogs), source(arm, "arm"))


@overload
def analyze(
    arm: Described,
    pose: Union[None, Vector, Mapping] = None,
    *,
    cases: None = None,
    payload_kg: Optional[float] = None,
    payload_cg_m: Optional[Vector] = None,
    payload_inertia_kgm2: Optional[Vector] = None,
    force_n: Optional[Vector] = None,
    moment_nm: Optional[Vector] = None,
    links: Optional[str] = None,
    joints: Optional[str] = None,
    modes: int = 6,
    response_n: Optional[Vector] = None,
    response_hz: Optional[Vector] = None,
    damping: Optional[float] = None,
    catalogs: Optional[Catalogs] = None,
) -> Analysis: ...


@overload
def analyze(
    arm: Described,
    *,
    cases: Union[PathLike, Sequence[Mapping]],
    modes: int = 6,
    response_n: Optional[Vector] = None,
    response_hz: Optional[Vector] = None,
    damping: Optional[float] = None,
    catalogs: Optional[Catalogs] = None,
) -> List[Analysis]: ...


def analyze(
    arm: Described,
    pose: Union[None, Vector, Mapping] = None,
    *,
    cases: Union[None, PathLike, Sequence[Mapping]] = None,
    payload_kg: Optional[float] = None,
    payload_cg_m: Optional[Vector] = None,
    payload_inertia_kgm2: Optional[Vector] = None,
    force_n: Optional[Vector] = None,
    moment_nm: Optional[Vector] = None,
    links: Optional[str] = None,
    joints: Optional[str] = None,
    modes: int = 6,
    response_n: Optional[Vector] = None,
    response_hz: Optional[Vector] = None,
    damping: Optional[float] = None,
    catalogs: Optional[Catalogs] = None,
) -> Any:
    """Statics, modes and response of an arm, as ``armwright analyze --json`` prints them.

    One pose and load, or ``cases``: a file or a list with the keys of a cases file. With ``cases`` the answer is a list, and pose,
    payload, loads and models are those of the cases.

    :param arm: path, dict or JSON text of an arm file
    :param pose: one angle a driven joint, base to tip [deg]; or a mapping with the keys that ``pose`` has in a cases file.
        All zero if it is left out.
    :param payload_kg: payload mass [kg]; default: none
    :param payload_cg_m: its centre of gravity from the tip, in the last frame [m]
    :param payload_inertia_kgm2: its moments of inertia about its centre [kg m²]
    :param force_n: force at the tip, world axes [N]
    :param moment_nm: moment at the tip, world axes [N m]
    :param links: ``rigid``, ``bending`` (Eqs 1-6) or ``full``, which is the default
    :param joints: ``k2``, ``three_segment``, which is the default, or ``three_segment_k1``
    :param modes: how many modes
    :param response_n: amplitude of a harmonic force at the tip, world axes [N]; asks for the response at ``response_hz``
    :param response_hz: frequencies of the response [Hz]; default: 1, 2, ... 100
    :param damping: damping ratio of every mode, for the response; default: 0.02
    :returns: :class:`Analysis`, a dict with ``joint_torque_nm`` [N m], ``tip_displacement_m`` [m], ``shares`` [m], ``modes`` [Hz] and
        others (docs/arm-format.md); its ``text`` and ``remarks`` are what the program says besides
    :raises InputError: the arm or the cases are faulty
    :raises UsageError: a number of the response is none that it can have
    :raises TypeError: arguments do not go together
    """
    held = catalogs_or_builtin(catalogs)
    arm_source = source(arm, "arm")
    given = {
        "pose": pose, "payload_kg": payload_kg, "payload_cg_m": payload_cg_m, "payload_inertia_kgm2": payload_inertia_kgm2,
        "force_n": force_n, "moment_nm": moment_nm, "links": links, "joints": joints,
    }  # fmt: skip
    of_case = [name for name, value in given.items() if value is not None]
    if cases is not None and of_case:
        raise TypeError(f"cases have their own {', '.join(of_case)}: give cases alone, or no cases")
    of_response = {"response_hz": response_hz, "damping": damping}
    alone = [name for name, value in of_response.items() if value is not None]
    if response_n is None and alone:
        raise TypeError(f"{' and '.join(alone)} without response_n: give the amplitude of the force too")
    asked = [one_case(held, arm_source, given)] if cases is None else cases
    harmonic = None
    if response_n is not None:
        at_hz = _RESPONSE_HZ if response_hz is None else [finite(f, "response_hz", 0) for f in response_hz]
        ratio = 0.02 if damping is None else finite(damping, "damping", 0)
        harmonic = (vector(response_n, "response_n"), ratio, at_hz)
    asked_source = source(asked, "cases")
    results, texts, remarks = _armwright.analyze(held, arm_source, asked_source, whole(modes, "modes"), harmonic)
    answers = [Analysis(result, text, remarks) for result, text in zip(json.loads(results), texts)]
    return answers[0] if cases is None else answers


def one_case(held: Catalogs, arm: Any, given: Dict[str, Any]) -> Dict[str, Any]:
    """The case of the arguments of :func:`analyze`, by the keys of a cases file."""
    stated = {name: value for name, value in given.items() if value is not None}
    payload = [("payload_kg", "mass_kg"), ("payload_cg_m", "cg_m"), ("payload_inertia_kgm2", "inertia_about_cg_kgm2")]
    rest = [("force_n", "tip_force_n"), ("moment_nm", "tip_moment_nm"), ("links", "links"), ("joints", "joints")]
    case: Dict[str, Any] = {"name": "case", **{key: stated[name] for name, key in rest if name in stated}}
    case["payload"] = {"mass_kg": 0.0, **{key: stated[name] for name, key in payload if name in stated}}
    pose = given.get("pose")
    if isinstance(pose, Mapping):
        case["pose"] = pose
    else:
        case["pose_deg"] = [0.0] * len(_armwright.driven_joints(held, arm)) if pose is None else pose
    return case


def size(study: Described, *, design: Optional[str] = None, catalogs: Optional[Catalogs] = None) -> Sizing:
    """The sizing of every joint of a study's arm, tip first, as ``armwright size --json`` prints it.

    :param study: name of a built-in study, path, dict or JSON text
    :param design: a ``design_id``; without it, links of median mass
    :returns: :class:`Sizing`, a list with a dict a joint: demand [N m, rad/s], gear, motor, margin, the check that binds; its
        ``remarks`` are what the program says besides
    :raises EmptySpaceError: there is nothing to choose from
    :raises InfeasibleError: no drive holds at some joint
    """
    rows, remarks = _armwright.size(catalogs_or_builtin(catalogs), source(study, "study"), design)
    return Sizing(json.loads(rows), remarks)


def capacity(
    study: Described,
    *,
    design: Optional[str] = None,
    cases: Union[None, PathLike, Sequence[Mapping]] = None,
    limits: Union[None, PathLike, Mapping] = None,
    catalogs: Optional[Catalogs] = None,
) -> Dict[str, Any]:
    """The largest payload of a study's arm or of an arm, as ``armwright capacity --json`` prints it.

    :param study: name of a built-in study, path, dict or JSON text of a study; or path, dict or JSON text of an arm, which is
        judged at rest
    :param design: a ``design_id`` of the study; without it, links of median mass and the lightest drives
    :param cases: the poses of an arm, as :func:`analyze` takes them; without it, every joint stands at zero
    :param limits: what the joints of an arm may bear: a mapping from the joint's name to its largest torque [N m]; or a mapping with
        the keys of a limits file, or its path, which may state forces of prismatic joints too. Without it, those of the robot where the arm is
        one of :func:`from_urdf`, or of ``import.json`` beside the arm file, or else of the catalogs' gears and motors in the arm.
    :returns: dict with ``payload_kg`` [kg] (None if nothing limits it), ``pose``, ``joint``, ``check``, in ``table`` the same for every
        pose by itself, with its reach [m], and in ``remarks`` what a reader should know
    :raises InfeasibleError: the drives do not hold the study's own payload
    :raises UsageError: nothing is known of what the joints of an arm may bear
    """
    held = catalogs_or_builtin(catalogs)
    asked = source(study, "study")
    if limits is None and isinstance(study, Mapping):
        # what became of a robot has its limits, as import.json has them
        made = study.get("provenance")
        limits = made if isinstance(made, Mapping) and "robot" in made and "joints" in made else None
    elif isinstance(limits, Mapping) and "joints" not in limits:
        limits = {"joints": [{"name": joint, "max_torque_nm": most} for joint, most in limits.items()]}
    given = [None if what is None else source(what, name) for what, name in ((cases, "cases"), (limits, "limits"))]
    return json.loads(_armwright.capacity(held, asked, design, given[0], given[1]))


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
    is_text = isinstance(file, str) and file.lstrip(BLANK).startswith("<")
    robot = ("urdf", str(file)) if is_text else (path(file), None)
    arm, report = _armwright.from_urdf(catalogs_or_builtin(catalogs), robot, tip, given)
    return {**json.loads(arm), "provenance": json.loads(report)}


def studies() -> List[str]:
    """Names of the built-in studies, those of the paper included."""
    return _armwright.study_names()


def study(name: str) -> Dict[str, Any]:
    """The file of a built-in study, to be changed and given to :func:`run`.

    :raises UsageError: there is no such study, or it is one of the paper (:func:`paper`)
    """
    text = _armwright.study_text(name)
    if text is None:
        if name in studies():
            raise UsageError(f"{name!r} is a study of the paper and has no file; armwright.paper({name!r}) computes it")
        raise UsageError(f"no study is called {name!r}; known: {', '.join(studies())}")
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
    folders = [path(folder) for folder in campaigns]
    return Outcome(_armwright.reconcile(catalogs_or_builtin(catalogs), folders))


def predict(
    arm: Union[Described, Outcome], readings: PathLike, campaign: PathLike, *, catalogs: Optional[Catalogs] = None
) -> Prediction:
    """Readings with the model's value added to each, as ``armwright predict`` writes them.

    :param arm: an arm, corrected or not: path, dict or JSON text of an arm file, or what :func:`reconcile` found, with which the
        other arms on its trunk are corrected too
    :param readings: path of a file of static, modal, windup or positions readings
    :param campaign: path of the campaign.json that says how they were taken
    :returns: the table of the readings with columns such as ``model_dz_mm`` [mm] or ``model_frequency_hz`` [Hz]; its ``remark`` is
        what has to be said of it
    :raises InputError: every fault of the files
    """
    held = catalogs_or_builtin(catalogs)
    with tempfile.TemporaryDirectory(prefix="armwright-") as folder:
        if isinstance(arm, Outcome):
            arm.write(folder)
            name = os.path.join(folder, "arm.corrected.json")
        else:
            name, text = source(arm, "arm")
            if text is not None:
                # faults are those of the object, and not of a file that nobody has written
                _armwright.driven_joints(held, (name, text))
                name = os.path.join(folder, "arm.json")
                Path(name).write_text(text, encoding="utf-8")
        table, remark = _armwright.predict(held, name, path(readings), path(campaign))
    out = Prediction.from_csv(table)
    out.remark = remark
    return out
