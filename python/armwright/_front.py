"""The front of a study, and what can be asked of its designs."""

from __future__ import annotations

from typing import Any, Dict, List, Optional

import numpy as np

from . import _export, _questions
from .table import Table


class Designs(Table):
    """A table of designs, a row a design."""

    _texts = ("design_id", "near_to", "material", "shape", "profile", "gear", "motor", "binds")


class Front(Designs):
    """The designs of a study that no other dominates, lightest first, with the columns of ``front.csv``.

    ``front.objectives`` has tip deflection [mm], mass [kg] and lowest mode [Hz] of each design; ``front.arm(id)`` is a design
    as an arm file.
    """

    facts: Dict[str, Any]
    """What is known of the search, by the keys of ``run.json``: ``status``, ``designs_total``, ``gap``, ``elapsed_s``, ``remarks``,
    ``caveats``, ``not_checked`` and others. ``search_reason`` says why this search was chosen."""
    by_material: Dict[str, Front]
    """The fronts of the designs whose chosen links are all of one material. An exact search has them only if it found the
    whole front."""

    near: Optional[Designs]
    """The designs that are worse than some design of the front by at most ``within_percent``, nearest first, with the columns of
    ``near.csv``; None if they were not asked for, or if the front is not whole (``remarks`` says so)."""
    scatter: Optional[Designs]
    """How often each design is on the front, and how often it is each pick, if the ratings of its parts scatter as
    ``tolerance_percent`` says, with the columns of ``tolerance.csv``; None if this was not asked for."""

    def __init__(self, columns, rows, facts, study, catalogs, by_material=None, near=None, scatter=None):
        super().__init__(columns, rows)
        self.facts = facts
        self.by_material = by_material or {}
        self.near, self.scatter = near, scatter
        self._study = study
        self._catalogs = catalogs

    @property
    def status(self) -> str:
        """How the search ended: ``complete``, ``certified``, ``partial`` or ``interrupted``."""
        return self.facts["status"]

    @property
    def remarks(self) -> List[str]:
        """What a reader of the numbers should know, in sentences: what is left out of them, lives and backlash of gears, given
        drives that are too weak, parts whose figures are not their vendor's, and parts that could not be checked."""
        caveats = self.facts["caveats"]
        return [*self.facts["remarks"], *([caveats] if caveats else []), *self.facts["not_checked"]]

    @property
    def picks(self) -> Dict[str, str]:
        """The ``design_id`` of the picks by their names: ``lightest``, ``stiffest``, ``highest mode`` and ``knee``, which is nearest
        to the best of all three. The front of one material has none."""
        return {name: pick["design_id"] for pick in self.facts["picks"] for name in pick["names"]}

    @property
    def ids(self) -> List[str]:
        """The ``design_id`` of every design."""
        return list(self["design_id"])

    @property
    def objectives(self) -> np.ndarray:
        """Tip deflection [mm], mass [kg] and lowest mode [Hz], one row a design."""
        columns = ("tip_deflection_mm", "mass_kg", "lowest_mode_hz")
        return np.column_stack([self[column] for column in columns])

    def arm(self, design_id: str) -> Dict[str, Any]:
        """A design as an arm file, with every part resolved to numbers."""
        return _questions.design(self._study, design_id, catalogs=self._catalogs)[0]

    def cases(self, design_id: str) -> List[Dict[str, Any]]:
        """The cases in which a design is judged, for :func:`armwright.analyze`."""
        return _questions.design(self._study, design_id, catalogs=self._catalogs)[1]

    def size(self, design_id: str) -> _questions.Sizing:
        """The sizing of the joints of a design, as :func:`armwright.size` gives it."""
        return _questions.size(self._study, design=design_id, catalogs=self._catalogs)

    def capacity(self, design_id: str) -> Dict[str, Any]:
        """The largest payload of a design, as :func:`armwright.capacity` gives it."""
        return _questions.capacity(self._study, design=design_id, catalogs=self._catalogs)

    def export(
        self,
        design_id: str,
        to: str,
        *,
        case: Optional[str] = None,
        pieces_per_link: Optional[int] = None,
        backlash: bool = False,
    ) -> _export.Export:
        """A design as files for another program, as :func:`armwright.export` makes them, in a case of its study."""
        arm, cases = _questions.design(self._study, design_id, catalogs=self._catalogs)
        return _export.export(
            arm, to, cases=cases, case=case, pieces_per_link=pieces_per_link, backlash=backlash, catalogs=self._catalogs
        )

    def lightest(self) -> Optional[str]:
        """The ``design_id`` of the lightest design."""
        return self.ids[0] if len(self) else None
