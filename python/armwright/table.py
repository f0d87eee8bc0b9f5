"""Tables of results: columns by name, as NumPy arrays and for pandas."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Optional, Sequence, Type, TypeVar

import numpy as np

if TYPE_CHECKING:
    import pandas


T = TypeVar("T", bound="Table")


def _array(cells: Sequence[str]) -> np.ndarray:
    """Numbers with NaN for blank cells; text where any cell is not a number."""
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells], dtype=float)
    except ValueError:
        return np.array(cells, dtype=object)


class Table:
    """A table whose column names carry their units, such as ``mass_kg``.

    ``table["mass_kg"]`` is the column as an array: floats, NaN where nothing is known, or an object array of ``str``.
    """

    columns: List[str]
    """Names of the columns, in the order of the CSV file."""

    #: Names, or last words of names after ``_``, of columns that are text whatever is in them.
    _texts: Sequence[str] = ()

    def __init__(self, columns: Sequence[str], rows: Sequence[Sequence[str]]):
        self.columns = list(columns)
        self._rows = [list(row) for row in rows]
        self._arrays: Dict[str, np.ndarray] = {}

    @classmethod
    def from_csv(cls: Type[T], text: str) -> T:
        """The table of a CSV text with a heading."""
        rows = list(csv.reader(io.StringIO(text)))
        return cls(rows[0], rows[1:]) if rows else cls([], [])

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[Dict[str, Any]]:
        for index in range(len(self)):
            yield self.row(index)

    def __getitem__(self, column: str) -> np.ndarray:
        if column not in self._arrays:
            if column not in self.columns:
                raise KeyError(f"{column!r}; the columns are {', '.join(self.columns)}")
            at = self.columns.index(column)
            cells = [row[at] for row in self._rows]
            is_text = column in self._texts or column.rsplit("_", 1)[-1] in self._texts
            array = np.array(cells, dtype=object) if is_text else _array(cells)
            array.setflags(write=False)
            self._arrays[column] = array
        return self._arrays[column]

    def row(self, index: int) -> Dict[str, Any]:
        """One row by column name."""
        return {column: self[column][index] for column in self.columns}

    def to_dict(self) -> Dict[str, np.ndarray]:
        """Every column by its name."""
        return {column: self[column] for column in self.columns}

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame of all columns (needs pandas: ``pip install armwright[pandas]``)."""
        import pandas

        return pandas.DataFrame(self.to_dict(), columns=self.columns)

    def to_csv(self) -> str:
        """The table as CSV, every number to its last digit."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(self._rows)
        return out.getvalue()

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {len(self)} rows of {len(self.columns)} columns>"


class Prediction(Table):
    """Readings with the model's values in columns whose names begin with ``model_``."""

    remark: Optional[str] = None
    """What has to be said about the prediction, if anything."""
