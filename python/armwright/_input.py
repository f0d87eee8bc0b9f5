"""What a call may get: names, paths, JSON text and Python objects."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, Optional, Tuple

from ._armwright import Catalogs

Source = Tuple[str, Optional[str]]


@lru_cache(maxsize=None)
def _builtin() -> Catalogs:
    return Catalogs.builtin()


def catalogs_or_builtin(catalogs: Optional[Catalogs]) -> Catalogs:
    """The catalogs of a call; the built-in ones are read once."""
    return _builtin() if catalogs is None else catalogs


def plain(value: Any) -> Any:
    """A value of NumPy as one of Python, for JSON."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{type(value).__name__} does not go into JSON: {value!r}")


def source(value: Any, what: str) -> Source:
    """A name or path as it is; JSON text and Python objects as text that is called `what` in messages."""
    if isinstance(value, os.PathLike):
        return os.fspath(value), None
    if isinstance(value, str):
        return (what, value) if value.lstrip()[:1] in ("{", "[") else (value, None)
    return what, json.dumps(value, default=plain, indent=1)
