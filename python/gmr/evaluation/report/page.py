"""The page put together: template, style, scripts, data; one file that loads nothing."""

from __future__ import annotations

import json
import re
from importlib import resources
from importlib.metadata import version
from typing import Any

from gmr.evaluation.figures import Figure, figures
from gmr.evaluation.figures.clip_usage import recordings
from gmr.evaluation.figures.theme import DARK, LIGHT
from gmr.evaluation.figures.transition_matrix import flows
from gmr.evaluation.report.columns import packed
from gmr.evaluation.report.document import json_text, own, script_hash, text
from gmr.evaluation.report.replay import packed_replay
from gmr.evaluation.report.sections import clip_groups, facts, sections
from gmr.evaluation.result import Evaluation

__all__ = ["page"]

_SCRIPTS = ("data.js", "charts.js", "scatter.js", "tables.js", "camera.js", "drawing.js", "player.js")


def page(evaluation: Evaluation) -> str:
    """The report as HTML."""
    drawn = list(figures(evaluation))
    vega, script = _vega(), _scripts()
    values = {
        "title": text(f"{evaluation.dataset}: locomotion dataset evaluation"),
        "dataset": text(evaluation.dataset),
        "version": text(version("gmr-motion")),
        "facts": facts(evaluation.summary),
        "sections": sections(evaluation, drawn),
        "style": _style(),
        "script_hashes": f"{script_hash(vega)} {script_hash(script)}",
        "data": json_text(_data(evaluation, drawn)),
        "vega": vega,
        "script": script,
    }
    # Filled in one go, so that nothing in a value is taken for a place to fill.
    return re.sub(r"\{\{(\w+)\}\}", lambda place: values[place[1]], own("page.html"))


def _data(evaluation: Evaluation, drawn: list[Figure]) -> dict[str, Any]:
    saved = {
        "trials": evaluation.measured.trials,
        "clips": recordings(evaluation.measured.clips),
        "jumps": flows(evaluation.measured.transitions),
    }
    tables = {name: packed(table, exact=True) for name, table in saved.items()}
    charts: dict[str, Any] = {}
    for figure in drawn:
        named = {name: f"{figure.name}/{name}" for name in figure.data}
        tables |= {named[name]: packed(table) for name, table in figure.data.items()}
        spec = figure.dressed()
        renderer = spec.get("usermeta", {}).get("renderer", "svg")
        charts[figure.name] = {"spec": spec, "tables": named, "renderer": renderer}
    clips, groups = clip_groups(evaluation)
    return {
        "tables": tables,
        "figures": charts,
        "clips": clips,
        "clipGroups": list(groups.values()),
        "replay": packed_replay(evaluation.replay, evaluation.summary.joints.get("hips")),
    }


def _scripts() -> str:
    """The page's scripts as one, in a function of its own, so that their names meet no others."""
    bodies = "\n".join(own(name).removeprefix('"use strict";\n') for name in _SCRIPTS)
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
    return f":root{{{light}}}\n{dark_only}\n{own('page.css')}"
