"""The search of a study."""

from __future__ import annotations

import json
from typing import Any, Callable, Dict, Optional

from . import _armwright
from ._armwright import Catalogs
from ._front import Front
from ._input import catalogs_or_builtin, finite, source, whole
from ._questions import Described
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
    :param threads: worker threads; 0 is one a core. Results do not depend on it.
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

    def front(found: Any) -> Front:
        (columns, rows), materials, facts, text = found
        facts = json.loads(facts)
        # a file may change: the designs of this front are those of the study as it was read
        of_material = {**facts, "picks": []}
        by_material = {name: Front(c, r, of_material, text, held) for name, (c, r) in materials}
        return Front(columns, rows, facts, text, held, by_material)

    try:
        return front(_armwright.run(held, asked, search, gap_percent, time_limit_s, threads, progress))
    except KeyboardInterrupt as stopped:
        interrupted = Interrupted(*stopped.args)
        found = getattr(stopped, "_found", None)
        if found is not None and found[0][1]:
            interrupted.front = front(found)
        raise interrupted from None
