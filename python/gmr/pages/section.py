"""A section that a page is given besides its own: HTML, and what its charts and tables hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["Section"]


@dataclass(frozen=True, slots=True)
class Section:
    """One section.

    Attributes:
        name: its place on the page.
        title: what a list of sections calls it.
        html: of the whole section, an element with the id ``name``.
        figures: the charts that it holds, as elements with the class ``chart`` and ``data-figure``.
        tables: what its buttons save, by name.
    """

    name: str
    title: str
    html: str
    figures: tuple[Figure, ...] = ()
    tables: Mapping[str, Table] = field(default_factory=dict)
