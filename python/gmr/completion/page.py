"""The completion's page: words first, then the maps, then the clips."""

from __future__ import annotations

from collections.abc import Mapping

from gmr.completion.complete import Completion
from gmr.completion.figures import figures
from gmr.completion.parts import LACKING, MAPS, clips_table, clips_title, maps, method
from gmr.completion.words import headline, sentences
from gmr.evaluation.words import duration
from gmr.pages.document import element, items, own, section, text
from gmr.pages.page import Page

__all__ = ["page"]


def page(of: Completion, strips: Mapping[str, str]) -> str:
    """The page as HTML.

    Args:
        of: what to show.
        strips: SVG pictures of some of the clips that were made, by clip.
    """
    drawn = list(figures(of))
    return Page(
        title=f"{of.dataset}: completed",
        eyebrow="Locomotion dataset, its holes filled",
        heading=of.dataset,
        facts=_facts(of),
        sections="\n".join(
            filter(
                None,
                [
                    _verdict(of),
                    section("maps", "Before and after", MAPS, maps(drawn)),
                    _strips(strips),
                    _clips(of),
                    _spoken(of),
                    section("method", "Method", "", method(of)),
                ],
            )
        ),
        figures=drawn,
        tables={"trials": of.trials, "clips": of.clips, **({"chosen": of.chosen} if of.source else {})},
        scripts=[own("gmr.evaluation.report", "tables.js")],
    ).html()


def _facts(of: Completion) -> dict[str, str]:
    return {
        "clips": f"{of.before.summary.clip_count:,}",
        "chosen clips" if of.source else "made clips": f"{len(of.added):,}",
        "of the dataset": duration(of.before.summary.seconds),
        "chosen" if of.source else "made": duration(float(of.clips["seconds"].sum())),
    }


def _verdict(of: Completion) -> str:
    body = element("h2", text(headline(of))) + element("ul", items(sentences(of)))
    return element("section", body, id="verdict")


def _strips(strips: Mapping[str, str]) -> str:
    pictures = "".join(
        element(
            "figure",
            element("figcaption", element("h3", text(name))) + element("div", svg, class_="strip"),
            class_="figure",
        )
        for name, svg in strips.items()
    )
    lead = "Some of the clips, from the side, time running to the right."
    return section("strips", "What was added", lead, pictures) if strips else ""


def _clips(of: Completion) -> str:
    if not of.added:
        return ""
    lead, table = (LACKING, "chosen") if of.source else ("", "clips")
    return section("clips", clips_title(of), lead, clips_table(of, table))


def _spoken(of: Completion) -> str:
    parts = ""
    for when, evaluation in (("Before", of.before), ("After", of.after)):
        said = element("p", element("strong", text(evaluation.verdict.headline)))
        said += element("ul", items(evaluation.verdict.sentences))
        parts += element("details", element("summary", f"{when}: the evaluation in words") + said)
    return section("spoken", "Both evaluations", "", parts)
