"""Parts of the page that a report of one dataset and one of several share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from gmr.evaluation.words import count
from gmr.pages.document import element, items, text

__all__ = ["failed_notice", "folded", "verdict_section"]


def verdict_section(headline: str, sentences: Sequence[str], places: Mapping[str, str]) -> str:
    """The words that come first, and links to the sections: their titles by their places on the page."""
    links = "".join(
        element("li", element("a", text(title), href=f"#{place}")) for place, title in places.items()
    )
    return element(
        "section",
        element("h2", text(headline))
        + element("ul", items(sentences))
        + element("nav", element("ul", links), aria_label="Sections"),
        id="verdict",
    )


def failed_notice(failed: Mapping[str, str]) -> str:
    """The files that could not be used, and why."""
    if not failed:
        return ""
    rows = "".join(
        element("li", element("code", text(file)) + ": " + text(reason)) for file, reason in failed.items()
    )
    title = f"{count(len(failed), 'file')} could not be used"
    return element("div", element("h2", text(title)) + element("ul", rows), class_="notice", id="failed")


def folded(title: str, content: str, name: str | None = None) -> str:
    """What is shown when its title is opened."""
    return element(
        "details", element("summary", text(title)) + element("div", content, class_="inside"), id=name
    )
