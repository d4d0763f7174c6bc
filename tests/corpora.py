"""Small corpora of simple actions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gmr.actionlets.corpus import Plan, Written, planned, write_corpus
from simple_actions import simple


def asked(variations: int = 9, **asked_for: Any) -> Plan:
    """The plan of so many swayings and noddings, of other bodies and of two lengths."""
    settings = {"seconds": "0.8,1.2", "height": "1.5..1.9", "sex": "male,female"}
    settings |= asked_for.pop("settings", {})
    parameters = {"nod.tempo": "1.4..2"} | asked_for.pop("parameters", {})
    return planned(
        simple(), ["sway", "nod"], variations, seed=7, settings=settings, parameters=parameters, **asked_for
    )


def write(folder: str | Path, plan: Plan | None = None, **how: Any) -> Written:
    """The corpus, written by one worker where nobody says."""
    return write_corpus(plan or asked(), simple(), folder, **{"workers": 1, **how})


def tree(folder: Path) -> dict[str, bytes]:
    """All files below a folder."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
