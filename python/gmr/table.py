"""A table of named columns, and its three files: CSV, JSON and Parquet.

The same table gives the same bytes on every machine: rows stay in their order, numbers are printed as the
shortest text that reads back to the same value, lines end in a newline only.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, BinaryIO, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.errors import MissingExtraError
from gmr.replacing import replacing

if TYPE_CHECKING:
    import pyarrow

__all__ = ["FORMATS", "Table"]


class Table:
    """Columns of equal length by name, in a fixed order; cannot be changed.

    Text columns are arrays of ``str`` objects, all others plain NumPy numbers or booleans.
    ``dict(table)`` gives the columns, so ``pandas.DataFrame(dict(table))`` and
    ``polars.DataFrame(dict(table))`` work without pyarrow.

    Args:
        columns: (N,) values of every column by its name.

    Raises:
        ValueError: the columns differ in length, or one is not one-dimensional.
    """

    __slots__ = ("_columns",)

    def __init__(self, columns: Mapping[str, ArrayLike]) -> None:
        self._columns: Final = {name: _column(name, values) for name, values in columns.items()}
        lengths = {name: len(column) for name, column in self._columns.items()}
        if len(set(lengths.values())) > 1:
            raise ValueError(f"the columns of a table must be of one length; these are {lengths}")

    @property
    def column_names(self) -> tuple[str, ...]:
        """The names of the columns, in order."""
        return tuple(self._columns)

    def __len__(self) -> int:
        """Number of rows."""
        return len(next(iter(self._columns.values()), ()))

    def __getitem__(self, name: str) -> NDArray[Any]:
        """The column ``name``, (N,), read-only."""
        return self._columns[name]

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def keys(self) -> tuple[str, ...]:
        """The names of the columns: with this and ``[]``, ``dict(table)`` gives the columns."""
        return self.column_names

    def rows(self) -> Iterator[dict[str, Any]]:
        """Every row as a dict of plain Python values."""
        names = self.column_names
        for values in zip(*(column.tolist() for column in self._columns.values()), strict=True):
            yield dict(zip(names, values, strict=True))

    def take(self, rows: ArrayLike) -> Table:
        """The table of some rows: their indices in the order wanted, or a mask of N booleans."""
        chosen = np.asarray(rows)
        return Table({name: column[chosen] for name, column in self._columns.items()})

    @classmethod
    def joined(cls, tables: Sequence[Table]) -> Table:
        """The rows of several tables of the same columns, one table after the other.

        Raises:
            ValueError: there is no table, or one has other columns.
        """
        if len({table.column_names for table in tables}) != 1:
            raise ValueError(
                "tables can be joined that have the same columns in the same order, one at least"
            )
        return cls(
            {name: np.concatenate([table[name] for table in tables]) for name in tables[0].column_names}
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Table):
            return NotImplemented
        return self.column_names == other.column_names and all(
            _same(self[name], other[name]) for name in self.column_names
        )

    __hash__ = None  # type: ignore[assignment]  # compared by value, and large

    def __repr__(self) -> str:
        return f"Table({len(self)} rows: {', '.join(self.column_names)})"

    def to_arrow(self) -> pyarrow.Table:
        """The table as ``pyarrow.Table``.

        Raises:
            MissingExtraError: pyarrow is not installed.
        """
        try:
            import pyarrow
        except ImportError as error:
            raise MissingExtraError("pyarrow", "report", "An Arrow table or a Parquet file") from error
        text = pyarrow.string()
        return pyarrow.table(
            {
                name: pyarrow.array(column, type=text if column.dtype == object else None)
                for name, column in self._columns.items()
            }
        )

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write comma-separated values, UTF-8, one header line; a number that is not finite is empty."""
        with replacing(path) as (file,):
            self.write_csv(file)

    def to_json(self, path: str | os.PathLike[str]) -> None:
        """Write a JSON list of objects, one row a line; a number that is not finite is ``null``."""
        with replacing(path) as (file,):
            self.write_json(file)

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Write a Parquet file.

        Raises:
            MissingExtraError: pyarrow is not installed.
        """
        with replacing(path) as (file,):
            self.write_parquet(file)

    def write_csv(self, file: BinaryIO) -> None:
        """Write what :meth:`to_csv` writes into an open file."""
        file.write(",".join(_quoted(name) for name in self.column_names).encode() + b"\n")
        cells = [_cells(column, "", _quoted) for column in self._columns.values()]
        file.write("".join(f"{','.join(row)}\n" for row in zip(*cells, strict=True)).encode())

    def write_json(self, file: BinaryIO) -> None:
        """Write what :meth:`to_json` writes into an open file."""
        keys = [f"{_json_text(name)}:" for name in self.column_names]
        cells = [
            [key + cell for cell in _cells(column, "null", _json_text)]
            for key, column in zip(keys, self._columns.values(), strict=True)
        ]
        rows = (f"{{{','.join(row)}}}" for row in zip(*cells, strict=True))
        file.write(b"[\n" + ",\n".join(rows).encode() + b"\n]\n")

    def write_parquet(self, file: BinaryIO) -> None:
        """Write what :meth:`to_parquet` writes into an open file."""
        table = self.to_arrow()
        import pyarrow.parquet

        pyarrow.parquet.write_table(table, file)


FORMATS: Final[Mapping[str, Callable[[Table, BinaryIO], None]]] = {
    "csv": Table.write_csv,
    "json": Table.write_json,
    "parquet": Table.write_parquet,
}
"""How a table is written, by the suffix of the file."""


def _column(name: str, values: ArrayLike) -> NDArray[Any]:
    column = np.array(values)
    if column.ndim != 1:
        raise ValueError(f"column '{name}' has the shape {column.shape}; a column is one-dimensional")
    if column.dtype.kind in "US":
        column = column.astype(object)
    column.flags.writeable = False
    return column


def _same(a: NDArray[Any], b: NDArray[Any]) -> bool:
    return np.array_equal(a, b, equal_nan=a.dtype.kind == "f" and b.dtype.kind == "f")


def _cells(column: NDArray[Any], unknown: str, text: Callable[[str], str]) -> list[str]:
    match column.dtype.kind:
        case "O":
            cell = {value: text(value) for value in dict.fromkeys(column.tolist())}
            return [cell[value] for value in column.tolist()]
        case "b":
            return ["true" if value else "false" for value in column.tolist()]
        case "f":
            # A float32 is printed by NumPy, which knows how few digits it needs; a float64 by Python, faster.
            shortest = column.astype(str) if column.dtype.itemsize < 8 else map(repr, column.tolist())
            known = np.isfinite(column).tolist()
            return [str(cell) if finite else unknown for cell, finite in zip(shortest, known, strict=True)]
        case _:
            return list(map(str, column.tolist()))


def _quoted(text: str) -> str:
    """A cell of comma-separated values (RFC 4180)."""
    if any(mark in text for mark in ',"\r\n'):
        return '"' + text.replace('"', '""') + '"'
    return text


def _json_text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
