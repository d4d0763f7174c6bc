"""A page put together: template, style, scripts, data; one file that loads nothing."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import resources
from importlib.metadata import version
from typing import Any, Final

from gmr.pages.columns import packed
from gmr.pages.document import element, json_text, own, script_hash, text
from gmr.pages.figure import Figure
from gmr.pages.theme import DARK, LIGHT
from gmr.table import Table

__all__ = ["Page"]

_FIRST: Final = ("data.js", "charts.js")
"""Scripts of every page, before its own."""


@dataclass(frozen=True, slots=True)
class Page:
    """What stands on a page.

    Attributes:
        title: of the window.
        eyebrow: the line above the heading: what kind of page this is.
        heading: what it is about.
        facts: the figures below the heading: how much, by what.
        sections: HTML of the rest; the first has the id ``verdict``.
        figures: the charts that the sections hold, as elements with the class ``chart`` and ``data-figure``.
        tables: saved with the page besides the figures' data.
        data: what the page's own scripts read besides.
        scripts: their texts, in order.
        without_scripts: what a browser without JavaScript says is missing.
        wide: whether figures stand side by side, and may take a large screen's whole width.
    """

    title: str
    eyebrow: str
    heading: str
    facts: Mapping[str, str]
    sections: str
    figures: Sequence[Figure]
    tables: Mapping[str, Table] = field(default_factory=dict)
    data: Mapping[str, Any] = field(default_factory=dict)
    scripts: Sequence[str] = ()
    without_scripts: str = "the charts need JavaScript, which is off in this browser"
    wide: bool = False

    def html(self) -> str:
        """The whole file."""
        vega, script = _vega(), _joined([*(own(__package__, name) for name in _FIRST), *self.scripts])
        values = {
            "title": text(self.title),
            "eyebrow": text(self.eyebrow),
            "heading": text(self.heading),
            "version": text(version("gmr-motion")),
            "facts": self._facts(),
            "width": "wide" if self.wide else "column",
            "sections": self.sections,
            "without_scripts": text(self.without_scripts),
            "style": _style(),
            "script_hashes": f"{script_hash(vega)} {script_hash(script)}",
            "data": json_text(self._packed()),
            "vega": vega,
            "script": script,
        }
        # Filled in one go, so that nothing in a value is taken for a place to fill.
        return re.sub(r"\{\{(\w+)\}\}", lambda place: values[place[1]], own(__package__, "page.html"))

    def _facts(self) -> str:
        return "\n".join(
            element("div", element("dt", text(what)) + element("dd", text(amount)))
            for what, amount in self.facts.items()
        )

    def _packed(self) -> dict[str, Any]:
        tables = {name: packed(table, exact=True) for name, table in self.tables.items()}
        charts: dict[str, Any] = {}
        for figure in self.figures:
            named = {name: f"{figure.name}/{name}" for name in figure.data}
            tables |= {named[name]: packed(table) for name, table in figure.data.items()}
            spec = figure.dressed()
            renderer = spec.get("usermeta", {}).get("renderer", "svg")
            charts[figure.name] = {"spec": spec, "tables": named, "renderer": renderer}
        return {"tables": tables, "figures": charts, **self.data}


def _joined(scripts: Sequence[str]) -> str:
    """Scripts as one, in a function of its own, so that their names meet no others."""
    bodies = "\n".join(script.removeprefix('"use strict";\n') for script in scripts)
    return f'\n(() => {{\n"use strict";\n{bodies}}})();\n'


def _vega() -> str:
    folder = resources.files("gmr").joinpath("data", "vega")
    licences, bundle = (
        folder.joinpath(name).read_text(encoding="utf-8") for name in ("LICENSES.txt", "vega.js")
    )
    versions = json.loads(folder.joinpath("versions.json").read_text(encoding="utf-8"))
    named = ", ".join(f"{package} {number}" for package, number in versions.items())
    return f"\n/*! {named}\n\n{licences.replace('*/', '* /')}*/\n{bundle}\n"


def _style() -> str:
    light, dark = (
        "".join(f"--{name}:{colour};" for name, colour in colours.items()) for colours in (LIGHT, DARK)
    )
    dark_only = f"@media screen and (prefers-color-scheme: dark){{:root:not(.printing){{{dark}}}}}"
    return f":root{{{light}}}\n{dark_only}\n{own(__package__, 'page.css')}"
