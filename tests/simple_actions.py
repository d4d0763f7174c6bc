"""A library file with two actions of one joint each, which are quickly done."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from gmr.actionlets import Library, library

FILE = Path(__file__).parent / "data" / "simple_actions.toml"


@cache
def simple() -> Library:
    """The library with these actions: "sway", which goes on, and "nod", which takes 0.25 to 1 s."""
    return library(FILE)
