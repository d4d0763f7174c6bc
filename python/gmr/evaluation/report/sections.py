"""The sections of the page in reading order: words first, then figures, then tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from gmr.evaluation.figures import Figure
from gmr.evaluation.figures.clip_usage import never_played
from gmr.evaluation.figures.trial_maps import trial_sets
from gmr.evaluation.replay import worst_trial
from gmr.evaluation.report.method import SOURCE, terms
from gmr.evaluation.report.parts import (
    VIEWS,
    failed_notice,
    folded,
    map_choice,
    map_controls,
    tables_section,
    verdict_section,
)
from gmr.evaluation.report.replay import replay_sentence
from gmr.evaluation.result import Evaluation, Summary
from gmr.evaluation.words import count, duration
from gmr.pages.document import element, items, own, section, text
from gmr.pages.section import Section
from gmr.table import Table

__all__ = ["clip_groups", "facts", "sections"]

_MOST_PLAYED: Final = 10


def facts(summary: Summary) -> dict[str, str]:
    """The dataset in figures."""
    mirrored = {"Mirrored copies": f"{summary.mirrored_count:,}"} if summary.mirrored_count else {}
    return {
        "Clips": f"{summary.clip_count:,}",
        **mirrored,
        "Duration with copies" if mirrored else "Duration": duration(summary.seconds),
        f"Frames at {summary.rate:g} Hz": f"{summary.frame_count:,}",
        "Joints": f"{summary.joint_count:,}",
    }


def sections(
    evaluation: Evaluation,
    figures: Sequence[Figure],
    tables: Mapping[str, Table],
    added: Sequence[Section] = (),
) -> str:
    """The body of the page; what is ``added`` stands before the replay."""
    drawn = {figure.name: figure for figure in figures}
    maps = [figure for figure in figures if figure.name.startswith("trial_map_")]
    paths = [figure for figure in figures if figure.name.startswith("planned_paths")]
    parts = [
        _verdict(evaluation, added),
        failed_notice(evaluation.failed),
        _notes(evaluation.notes),
        section(
            "coverage",
            "What the dataset holds",
            "Speed and turn rate, as means over one second that slides through every clip.",
            _scatter(drawn["coverage_scatter"], evaluation)
            + "".join(
                _figure(drawn[name]) for name in ("coverage_density", "pose_distance", "turn_symmetry")
            ),
        ),
        section(
            "accuracy",
            "How well it follows a path",
            "In every trial a character driven by motion matching is sent along a circle, or straight ahead, "
            "at one speed and one turn rate. A cell is a trial; what stands after ± is its spread over time.",
            _maps(maps, evaluation) + "".join(map(_figure, paths)),
        ),
        section(
            "course",
            "What happens in a trial",
            "",
            _figures(drawn, "speed_switches", "cost_over_time", "error_distribution"),
        ),
        section(
            "relevance",
            "Which clips carry it",
            "",
            _figure(drawn["clip_usage"]) + _never(evaluation) + _figure(drawn["frame_usage"]),
        ),
        section(
            "transitions",
            "How it gets from clip to clip",
            "A jump is a step at which the frame shown is not the next one of its clip.",
            "".join(
                _figure(drawn[name]) for name in ("transition_kinds", "transition_matrix", "clip_circles")
            ),
        ),
        *(each.html for each in added),
        _replay(evaluation),
        tables_section(tables),
        section("method", "How it was measured", SOURCE, terms(evaluation.summary)),
    ]
    return "\n".join(filter(None, parts))


def clip_groups(evaluation: Evaluation) -> tuple[list[str], dict[str, list[str]]]:
    """What the coverage scatter can pick out: every clip by name, and groups of clips."""
    clips = sorted(dict.fromkeys(evaluation.measured.coverage["clip"].tolist()))
    table = evaluation.measured.clips
    played, names = table["played_seconds"], table["clip"]
    most = np.argsort(-played, kind="stable")[:_MOST_PLAYED]
    groups = {
        f"The {len(most)} clips played most": names[most[played[most] > 0]].tolist(),
        "Clips never played": names[played == 0].tolist(),
    }
    return clips, {label: members for label, members in groups.items() if members}


def _verdict(evaluation: Evaluation, added: Sequence[Section]) -> str:
    places = {
        "coverage": "Coverage",
        "accuracy": "Accuracy",
        "relevance": "Clips",
        "transitions": "Transitions",
        **{each.name: each.title for each in added},
        "replay": "Replay",
        "tables": "Tables",
        "method": "Method",
    }
    # The verdict closes with the notes, which the page shows in a box of their own.
    said = [sentence for sentence in evaluation.verdict.sentences if sentence not in evaluation.notes]
    return verdict_section(evaluation.verdict.headline, said, places)


def _notes(notes: Sequence[str]) -> str:
    if not notes:
        return ""
    content = element("h2", "Noticed on the way") + element("ul", items(notes))
    return element("div", content, class_="notice calm", id="notes")


def _figure(
    figure: Figure,
    controls: str = "",
    *,
    choice: str | None = None,
    hidden: bool = False,
    film: int | None = None,
) -> str:
    caption = element("figcaption", element("h3", text(figure.title)) + element("p", text(figure.sentence)))
    shape = "chart ring" if figure.chart["height"] == "container" else "chart"
    chart = element("div", "", class_=shape, data_figure=figure.name)
    if film is not None:
        chart = element("div", chart, class_="map", data_film=film)
    return element(
        "figure",
        caption + controls + chart,
        class_="figure",
        data_choice=choice,
        hidden=hidden,
        id=figure.name,
    )


def _figures(drawn: Mapping[str, Figure], *names: str) -> str:
    """The figures whose names begin with one of these, where there are any."""
    return "".join(_figure(figure) for name, figure in drawn.items() if name.startswith(names))


def _scatter(figure: Figure, evaluation: Evaluation) -> str:
    clips, groups = clip_groups(evaluation)
    grouped = "".join(
        element("option", text(f"{label} ({len(members):,})"), value=f"group:{number}")
        for number, (label, members) in enumerate(groups.items())
    )
    named = "".join(
        element("option", text(clip), value=f"clip:{number}") for number, clip in enumerate(clips)
    )
    choices = (
        element("option", "All clips, each in its colour", value="")
        + (element("optgroup", grouped, label="Groups") if grouped else "")
        + element("optgroup", named, label="One clip")
    )
    label = element("label", "Show", for_="clip-select")
    count = element("span", "", id="chosen-count", role="status")
    select = element("select", choices, id="clip-select", autocomplete="off")
    return _figure(figure, element("div", label + select + count, class_="controls"))


def _maps(maps: Sequence[Figure], evaluation: Evaluation) -> str:
    """All maps of the trials, of which the controls show one."""
    sets = trial_sets(evaluation)
    shown = iter(maps)
    content = ""
    for number in range(len(sets)):
        for place, name in enumerate(VIEWS):
            choice = map_choice(name, number, sets)
            film = None if evaluation.replays is None else 0
            content += _figure(next(shown), choice=choice, hidden=number + place > 0, film=film)
    return element("div", map_controls(sets) + content, data_choose=True)


def _never(evaluation: Evaluation) -> str:
    names = never_played(evaluation.measured.clips)
    if not names:
        return ""
    title = f"{count(len(names), 'clip')} never played"
    return folded(title, element("ul", items(names), class_="names"), "never-played")


def _replay(evaluation: Evaluation) -> str:
    if evaluation.replays is None:
        return ""
    worst = evaluation.replays.trials[worst_trial(evaluation.measured.trials)]
    player = own(__package__, "player.html").replace("{{sentence}}", text(replay_sentence(worst)))
    lead = (
        "A click on a cell of the maps above replays its trial; so does the list here. First comes the worst."
    )
    return section("replay", "Any trial, replayed", lead, player)
