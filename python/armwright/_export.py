"""An arm as files for another program."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Union

from . import _armwright
from ._armwright import Catalogs
from ._input import catalogs_or_builtin, source, whole
from ._questions import Described, PathLike, Vector, one_case


class Export:
    """The files of an arm for another program."""

    files: Dict[str, bytes]
    """The content of each file by its name."""
    json: Dict[str, Any]
    """``export.json``: the case, what the files leave out with its share of the tip deflection, and in ``expected`` what the other
    program should find (docs/interchange.md)."""

    def __init__(self, files: Dict[str, bytes]):
        self.files = files
        self.json = json.loads(files["export.json"])

    def text(self, name: str) -> str:
        """A file as text, such as the model for ``mujoco.MjModel.from_xml_string``."""
        return self.files[name].decode("utf-8")

    def write(self, folder: PathLike) -> List[Path]:
        """Writes the files and returns their paths."""
        Path(folder).mkdir(parents=True, exist_ok=True)
        paths = [Path(folder) / name for name in self.files]
        for place, content in zip(paths, self.files.values()):
            place.write_bytes(content)
        return paths

    def __repr__(self) -> str:
        return f"<armwright.Export to {self.json['to']}: {', '.join(self.files)}>"


def export(
    arm: Described,
    to: str,
    *,
    pose: Union[None, Vector, Mapping] = None,
    payload_kg: Optional[float] = None,
    payload_cg_m: Optional[Vector] = None,
    cases: Union[None, PathLike, Sequence[Mapping]] = None,
    case: Optional[str] = None,
    pieces_per_link: Optional[int] = None,
    backlash: bool = False,
    catalogs: Optional[Catalogs] = None,
) -> Export:
    """An arm in one case as files for another program, as ``armwright export`` writes them. Nothing is written to disk.

    :param arm: path, dict or JSON text of an arm file
    :param to: ``calculix``, ``mjcf``, ``urdf``, ``json``, ``csv`` or ``bom``
    :param pose: as in :func:`analyze`; all zero if it is left out
    :param payload_kg: payload mass [kg]; default: none
    :param payload_cg_m: its centre of gravity from the tip, in the last frame [m]
    :param cases: a cases file or a list with its keys, in place of pose and payload
    :param case: name of the case; default: the one with the largest tip deflection
    :param pieces_per_link: cuts every flexible link into so many pieces with springs between them (``mjcf``); without it links are
        rigid
    :param backlash: gives joints the backlash of their gears as a deadband (``mjcf``)
    :raises UsageError: the options do not go together, or the form cannot represent the arm
    :raises InputError: the arm or the cases are faulty
    :raises TypeError: cases and a pose or payload are given
    """
    held = catalogs_or_builtin(catalogs)
    of_arm = source(arm, "arm")
    given = {"pose": pose, "payload_kg": payload_kg, "payload_cg_m": payload_cg_m}
    stated = [name for name, value in given.items() if value is not None]
    if cases is not None and stated:
        raise TypeError(f"cases have their own {', '.join(stated)}: give cases alone, or no cases")
    asked = source([one_case(held, of_arm, given)] if cases is None else cases, "cases")
    pieces = None if pieces_per_link is None else whole(pieces_per_link, "pieces_per_link", 1, 200)
    _, files = _armwright.export(held, of_arm, asked, to, case, pieces, bool(backlash))
    return Export(dict(files))
