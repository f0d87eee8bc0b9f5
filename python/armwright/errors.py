"""Why a question has no answer.

Every exception says what is wrong and what to try. Those about input files carry all faults of the files at once in ``faults``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Iterable, List, Optional, Tuple


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with an input."""

    file: str
    """File as it was given; ``arm``, ``cases`` or ``study`` for a Python object."""
    line: Optional[int]
    """Line in the file, from 1; in the JSON text of a Python object, which has an indent of 1."""
    field: str
    """Path of the field, such as ``chain[2].section.wall_m``, or a column."""
    message: str
    """What is wrong, with the value seen."""
    hint: str
    """What is allowed, or what to try next."""


class ArmwrightError(Exception):
    """Any of the following."""


class InputError(ArmwrightError, ValueError):
    """An arm, a study, cases or readings are faulty; ``faults`` has every fault."""

    faults: List[Fault]

    def __init__(self, message: str, faults: Iterable[Tuple[str, Optional[int], str, str, str]] = ()):
        super().__init__(message)
        self.faults = [Fault(*fault) for fault in faults]


class CatalogError(InputError):
    """The rows of a catalog are faulty; ``faults`` has every fault."""


class UsageError(ArmwrightError, ValueError):
    """A name is not known, or options do not go together."""


class FileError(ArmwrightError, OSError):
    """A file cannot be read."""


class EmptySpaceError(ArmwrightError):
    """A study leaves nothing to choose from at some link or joint."""


class InfeasibleError(ArmwrightError):
    """No design meets what is asked. The message has the smallest relaxation of the limits that helps."""


class OutOfTimeError(ArmwrightError):
    """A time limit came before any design was found."""
