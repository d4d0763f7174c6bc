"""Pages: one self-contained HTML file each, words first, with charts, that opens offline on any device."""

from __future__ import annotations

from gmr.pages.figure import Figure
from gmr.pages.page import Page

__all__ = ["Figure", "Page"]
