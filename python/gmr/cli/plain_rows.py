"""Rows of tables as JSON can hold them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gmr.table import Table

__all__ = ["plain_row", "plain_rows"]


def plain_rows(table: Table) -> list[dict[str, Any]]:
    """Every row by the names of its columns."""
    return [plain_row(row) for row in table.rows()]


def plain_row(row: Mapping[str, Any]) -> dict[str, Any]:
    """JSON has no NaN: what is not known is null."""
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in row.items()
    }
