"""The manifest of a corpus: a Parquet file, a row a take."""

from __future__ import annotations

import io
from collections.abc import Iterable
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from gmr.actionlets.corpus.journal import Record
from gmr.actionlets.corpus.plan import Plan
from gmr.errors import FormatError, MissingExtraError
from gmr.replacing import replacing

if TYPE_CHECKING:
    import pyarrow

__all__ = ["MANIFEST", "check_pyarrow", "read_manifest", "write_manifest"]

MANIFEST: Final = "manifest.parquet"

_GROUP: Final = 1 << 16
"""Rows that are made at a time, and that a reader may read at a time."""


def check_pyarrow() -> None:
    """Raises MissingExtraError where pyarrow is not installed."""
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError as error:
        raise MissingExtraError("pyarrow", "corpus", "A corpus") from error


def write_manifest(path: Path, plan: Plan, records: Iterable[Record]) -> None:
    """Writes the manifest of these takes, in their order; one that is the same already is left alone."""
    import pyarrow
    import pyarrow.parquet

    rows, held, schema = map(_row, records), io.BytesIO(), _schema(plan)
    with pyarrow.parquet.ParquetWriter(held, schema, compression="zstd") as file:
        while group := list(islice(rows, _GROUP)):
            file.write_table(pyarrow.Table.from_pylist(group, schema))
    if path.exists() and path.read_bytes() == held.getvalue():
        return
    with replacing(path) as (file,):
        file.write(held.getvalue())


def read_manifest(path: Path) -> pyarrow.Table:
    """The table.

    Raises:
        MissingExtraError: pyarrow is not installed (the extra ``corpus``).
        FormatError: the file is missing, cut short, or no manifest.
    """
    check_pyarrow()
    import pyarrow
    import pyarrow.parquet

    again = "give the command that made the corpus again: it makes what is missing"
    try:
        found = pyarrow.parquet.read_table(path)
    except FileNotFoundError:
        raise FormatError(
            f"there is no manifest, the corpus is not finished; {again}", file=str(path)
        ) from None
    except (pyarrow.ArrowException, OSError) as error:
        raise FormatError(f"the manifest is damaged ({error!s:.200}); {again}", file=str(path)) from error
    if missing := [
        name for name in ("file", "action", "frames", "contacts") if name not in found.column_names
    ]:
        raise FormatError(f"this is no manifest of a corpus: it has no column '{missing[0]}'", file=str(path))
    return found


def _row(record: Record) -> dict[str, Any]:
    """A row: pairs and triples get names; a parameter that the action has not is null."""
    return record | {
        "phases": [{"label": label, "start": start, "end": end} for label, start, end in record["phases"]],
        "contacts": {
            side: [{"start": start, "end": end} for start, end in record["contacts"].get(side, ())]
            for side in ("left", "right")
        },
    }


def _schema(plan: Plan) -> pyarrow.Schema:
    import pyarrow as pa

    number, text = pa.float64(), pa.string()
    span = [("start", number), ("end", number)]
    spans = pa.list_(pa.struct(span))
    named = dict.fromkeys(name for own in plan.parameters.values() for name in own)
    settings = [(name, text if name == "sex" else number) for name in plan.settings if name != "seconds"]
    return pa.schema(
        [
            ("take", pa.int64()),
            ("file", text),
            ("action", text),
            ("index", pa.int64()),
            ("seed", pa.int64()),
            ("seconds", number),
            ("fps", number),
            ("frames", pa.int64()),
            ("body", text),
            *settings,
            *([("parameters", pa.struct([(name, number) for name in named]))] if named else []),
            ("phases", pa.list_(pa.struct([("label", text), *span]))),
            ("contacts", pa.struct([("left", spans), ("right", spans)])),
            ("bytes", pa.int64()),
            ("sha256", text),
        ],
        metadata={"plan": plan.to_json()},
    )
