"""What a call may get: names, paths, JSON text and Python objects."""

from __future__ import annotations

import copyreg
import json
import math
import operator
import os
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, Iterator, List, Optional, Tuple

from ._armwright import Catalogs
from .errors import FileError, InputError, UsageError

Source = Tuple[str, Optional[str]]

#: What may stand before the text of a file: blanks, and a byte order mark.
BLANK = "\ufeff \t\r\n"


@lru_cache(maxsize=None)
def _builtin() -> Catalogs:
    return Catalogs.builtin()


def catalogs_or_builtin(catalogs: Optional[Catalogs]) -> Catalogs:
    """The catalogs of a call; the built-in ones are read once."""
    return _builtin() if catalogs is None else catalogs


def _again(folder: Any) -> Catalogs:
    return _builtin() if folder is None else Catalogs.load(folder)


# fronts go to other processes with their catalogs
copyreg.pickle(Catalogs, lambda catalogs: (_again, (catalogs.folder,)))


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
        return path(value), None
    if isinstance(value, str):
        return (what, value) if value.lstrip(BLANK)[:1] in ("{", "[") else (path(value), None)
    try:
        return what, json.dumps(value, default=plain, indent=1, allow_nan=False)
    except ValueError:
        # a circular object has no text either
        text = json.dumps(value, default=plain)
    numbers = list(_not_finite(json.loads(text), ""))
    lines = "".join(f"\n  {what}: {field}: is {number}, not a finite number" for field, number in numbers)
    raise InputError(
        f"{len(numbers)} {'fault' if len(numbers) == 1 else 'faults'} in the input:{lines}",
        [(what, None, field, f"is {number}, not a finite number", "give a finite number") for field, number in numbers],
    )


def _not_finite(value: Any, field: str) -> Iterator[Tuple[str, float]]:
    """The field and value of every number that JSON does not have."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _not_finite(item, f"{field}.{key}" if field else key)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _not_finite(item, f"{field}[{index}]")
    elif isinstance(value, float) and not math.isfinite(value):
        yield field, value


def path(value: Any) -> str:
    """A path as text."""
    text = os.fspath(value)
    if isinstance(text, bytes):
        text = os.fsdecode(text)
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        raise FileError(f"the name {text!r} is not Unicode; rename the file or its folder") from None
    return text


def finite(value: Any, what: str, least: Optional[float] = None) -> float:
    """A number that is finite and not below `least`."""
    number = float(value)
    if not math.isfinite(number) or (least is not None and number < least):
        raise UsageError(f"{what} is {number:g}: give a finite number" + ("" if least is None else f" of {least:g} or more"))
    return number


def vector(value: Any, what: str) -> List[float]:
    """Three finite numbers."""
    numbers = [finite(x, what) for x in value]
    if len(numbers) != 3:
        raise UsageError(f"{what} has {len(numbers)} numbers: give 3, along x, y and z")
    return numbers


def whole(value: Any, what: str, least: int = 0, most: int = 2**64 - 1) -> int:
    """A whole number from `least` to `most`."""
    number = operator.index(value)
    if number < 0 and least == 0:
        raise UsageError(f"{what} is {number}: give a whole number that is not negative")
    if not least <= number <= most:
        raise UsageError(f"{what} is {number}: give a whole number from {least} to {most}")
    return number
