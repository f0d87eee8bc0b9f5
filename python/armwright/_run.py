"""The search of a study."""

from __future__ import annotations

import json
from typing import Any, Callable, Dict, Mapping, Optional, Tuple, Union

from . import _armwright
from ._armwright import Catalogs
from ._front import Designs, Front
from ._input import catalogs_or_builtin, finite, source, whole
from ._questions import Described, Outcome
from .errors import UsageError


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during :func:`run`. ``front`` has what was found until then, or is None."""

    front: Optional[Front] = None


def run(
    study: Described,
    *,
    progress: Optional[Callable[[Dict[str, Any]], Any]] = None,
    search: Optional[str] = None,
    gap_percent: Optional[float] = None,
    time_limit_s: Optional[float] = None,
    effects: Union[None, Described, Outcome] = None,
    within_percent: Optional[float] = None,
    within_most: int = 10_000,
    tolerance_percent: Optional[Mapping[str, float]] = None,
    samples: int = 1000,
    seed: int = 1,
    threads: int = 0,
    catalogs: Optional[Catalogs] = None,
) -> Front:
    """The front of a study: the designs that no other dominates in tip deflection, mass and lowest mode.

    The interpreter's lock is free while it works. Ctrl-C ends it and raises :class:`Interrupted`, whose ``front`` has what was
    found. Nothing is written to disk.

    :param study: name of a built-in study, path, dict or JSON text
    :param progress: is called five times a second with a dict of ``elapsed_s``, ``designs``, ``designs_total``, ``gap`` (a
        fraction), ``front_size`` and ``boxes_open``; None stands for what is not known. An exception that it raises ends the search.
    :param search: ``exhaustive``, ``exact``, or None for the one that is estimated to cost less
    :param gap_percent: the exact search may end when for every design some listed one is worse by at most this percentage in each
        objective; 0 asks for the whole front. Default: the study's.
    :param time_limit_s: ends an exact search [s]
    :param effects: a measured arm: what :func:`reconcile` found, or an arm file as :func:`analyze` takes it. Its effects and calibrated
        values are applied to the study's joints and links of the same name; ``facts["carried_over"]`` lists them, and those that do
        not apply with the reason.
    :param within_percent: also lists in ``near`` the designs that are worse than some design of the front by at most this percentage in
        mass, deflection and lowest mode. This takes a second search.
    :param within_most: the largest number of designs in ``near``, the nearest first
    :param tolerance_percent: scatter of ratings, such as ``{"gear_stiffness": 20, "mass": 2}``: 95 % of the rows of a catalog lie
        within it. ``scatter`` then has for each design the share of samples in which it is on the front.
    :param samples: number of samples of the scatter
    :param seed: seed of the samples; the same seed gives the same samples on any number of threads
    :param threads: worker threads; 0 is one a core. Results do not depend on it.
    :raises UsageError: a word or number is none that it can be, or no effect of ``effects`` applies to the study
    :raises InfeasibleError: no design meets the study; the message says which limits are in the way
    :raises EmptySpaceError: there is nothing to choose from
    :raises OutOfTimeError: the time limit came before any design was found
    """
    held = catalogs_or_builtin(catalogs)
    asked = source(study, "study")
    if progress is not None and not callable(progress):
        raise TypeError(f"progress is {progress!r}: give a function of one argument")
    if gap_percent is not None and not 0 <= gap_percent < 100:
        raise UsageError(f"gap_percent is {gap_percent}: give a percentage from 0 to below 100")
    if time_limit_s is not None:
        time_limit_s = finite(time_limit_s, "time_limit_s", 0)
    threads = whole(threads, "threads")
    measured = effects.corrected_arm if isinstance(effects, Outcome) else effects
    arm = None if measured is None else source(measured, "arm")
    within = None if within_percent is None else (_percentage(within_percent, "within_percent"), whole(within_most, "within_most", 1, 10_000_000))
    scatter = None if tolerance_percent is None else _scatter(tolerance_percent, whole(samples, "samples", 1, 1_000_000), whole(seed, "seed"))

    def front(found: Any) -> Front:
        (columns, rows), materials, further, facts, text = found
        facts = json.loads(facts)
        # a file may change: the designs of this front are those of the study as it was read
        of_material = {**facts, "picks": []}
        by_material = {name: Front(c, r, of_material, text, held) for name, (c, r) in materials}
        near, scattered = (None if table is None else Designs.from_csv(table) for table in further)
        return Front(columns, rows, facts, text, held, by_material, near, scattered)

    try:
        return front(_armwright.run(held, asked, arm, search, gap_percent, time_limit_s, within, scatter, threads, progress))
    except KeyboardInterrupt as stopped:
        interrupted = Interrupted(*stopped.args)
        found = getattr(stopped, "_found", None)
        if found is not None and found[0][1]:
            interrupted.front = front(found)
        raise interrupted from None


def _percentage(value: Any, what: str) -> float:
    """A percentage above 0 and below 100."""
    percent = finite(value, what, 0)
    if not 0 < percent < 100:
        raise UsageError(f"{what} is {percent:g}: give a percentage above 0 and below 100")
    return percent


def _scatter(ratings: Mapping[str, float], samples: int, seed: int) -> Tuple[str, int, int]:
    """The scatter of ratings as the program reads it, the number of samples and their seed."""
    parts = [f"{name}={_percentage(percent, f'the scatter of {name}')!r}%" for name, percent in ratings.items()]
    return ",".join(parts), samples, seed
