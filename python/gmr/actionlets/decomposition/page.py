"""The score on a page: staves like those of music, then how well each degree of freedom is met."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from gmr.actionlets.actionlet import Actionlet
from gmr.actionlets.decomposition.decomposed import Decomposed
from gmr.body.naming import side_and_part
from gmr.pages.columns import packed_array, steps
from gmr.pages.document import element, own, text
from gmr.pages.figure import Figure
from gmr.pages.page import Page
from gmr.pages.theme import NAMES_AXIS, NAMES_CONFIG, ROW
from gmr.table import Table

__all__ = ["page"]

_DRAWN_FPS: Final = 60.0
"""Samples of the recording that are drawn, a second, at most."""

_ORDER: Final = (
    "neck", "waist", "left_shoulder", "left_elbow", "left_wrist", "right_shoulder", "right_elbow",
    "right_wrist", "left_hip", "left_knee", "left_ankle", "right_hip", "right_knee", "right_ankle", "root",
)  # fmt: skip
"""Of the staves of a body: limb by limb, from the head down."""

_SIDES: Final = {"left": 0, "right": 1, "": 2}


def page(found: Decomposed, name: str) -> str:
    """The page as HTML.

    Args:
        found: what was decomposed.
        name: of the recording, for the heading.
    """
    shown = sorted(
        np.flatnonzero(found.moving).tolist(), key=lambda column: _place(found.recorded.dofs[column])
    )
    figure = _errors(found)
    return Page(
        title=f"{name}: its score",
        eyebrow="A score of actionlets",
        heading=name,
        facts=_facts(found),
        sections="\n".join([_verdict(found, len(shown)), _score(), _fit(figure), _method(found)]),
        figures=[figure],
        tables={"fit": found.table()},
        data={"score": _drawn(found, shown)},
        scripts=[own(__package__, "score.js")],
        without_scripts="the score and the chart need JavaScript, which is off in this browser",
    ).html()


def _facts(found: Decomposed) -> dict[str, str]:
    return {
        "seconds": f"{found.score.duration:.1f}",
        "degrees of freedom": f"{len(found.recorded.dofs)}",
        "actionlets": f"{found.score.piece_count:,}",
        "median error": f"{found.median_rms_deg:.2f}°",
        "smaller than its samples": f"{found.ratio:.0f}×",
    }


def _verdict(found: Decomposed, moving: int) -> str:
    worst = int(np.argmax(found.rms_deg))
    still = len(found.recorded.dofs) - moving
    said = [
        f"Nine in ten degrees of freedom are met within {found.p90_rms_deg:.2f}° RMS; farthest off is"
        f" {found.recorded.dofs[worst]} with {found.rms_deg[worst]:.2f}°.",
        f"{moving} degrees of freedom move"
        + (f"; {still} hold one angle throughout and are not drawn." if still else "."),
    ]
    head = (
        f"{found.score.piece_count:,} single movements make these {found.score.duration:.1f} seconds, "
        f"within {found.median_rms_deg:.2f}° (median RMS)."
    )
    body = element("h2", text(head)) + element("ul", "".join(element("li", text(s)) for s in said))
    return element("section", body, id="verdict")


def _score() -> str:
    legend = (
        '<p class="score-legend"><span class="key"><i class="bell"></i>an actionlet: its speed, up where the '
        "angle rises; the taller, the farther it goes</span>"
        '<span class="key"><i class="rest"></i>silence</span>'
        '<span class="key"><i class="line composed"></i>the composed angle</span>'
        '<span class="key"><i class="line recorded"></i>the recorded one</span></p>'
    )
    body = (
        element("style", own(__package__, "score.css"))
        + element("h2", "The score")
        + element(
            "p",
            "A stave for each degree of freedom, time from left to right, a bar line each second. Point at "
            "an actionlet for its angles, duration and skew.",
            class_="lead",
        )
        + legend
        + '<div class="score" role="img" aria-label="Staves with a bell for each actionlet"></div>'
        + '<div class="score-tip" role="status" hidden></div>'
    )
    return element("section", body, id="score")


def _fit(figure: Figure) -> str:
    shown = element(
        "figure",
        element("figcaption", element("h3", text(figure.title)) + element("p", text(figure.sentence)))
        + element("div", "", class_="chart", data_figure=figure.name),
        class_="figure",
        id=figure.name,
    )
    return element("section", element("h2", "How well it fits") + shown, id="fit")


def _method(found: Decomposed) -> str:
    words = [
        "An actionlet speeds up and slows down once: v(u) = (1 - cos(πu/T))/2 up to the share T of its "
        "duration, (1 + cos(π(u - T)/(1 - T)))/2 from there (Zheng et al., Human Motion Simulation and "
        "Action Corpus, Eq. 1). It goes from its first angle to its last, at rest at both.",
        "Cuts, angles and skews are chosen together: the track of least squared error plus a price for each "
        f"piece, {found.tolerance_deg:g}° for half a second, found by dynamic programming and refined by "
        "least squares.",
        "A bell is as tall as the square root of its way, so that small movements can be seen beside large "
        "ones. Each stave has its own range of angles, as written on it.",
        "Size: three numbers for each piece and one for each degree of freedom, against one for each sample.",
    ]
    return element(
        "section",
        element("h2", "Method") + element("ul", "".join(element("li", text(word)) for word in words)),
        id="method",
    )


def _errors(found: Decomposed) -> Figure:
    table = found.table().take(np.flatnonzero(found.moving))
    order = np.argsort(-table["rms_deg"], kind="stable")
    data = Table({name: table[name][order] for name in ("dof", "rms_deg", "pieces", "ratio")})
    worst = f"{data['dof'][0]} fits worst, {data['rms_deg'][0]:.2f}°." if len(data) else "Nothing moves."
    return Figure(
        name="errors",
        title="RMS error by degree of freedom, degrees",
        sentence=worst,
        chart={
            "data": {"name": "errors"},
            "width": "container",
            "height": ROW * max(len(data), 1),
            "mark": {"type": "bar", "color": "var(--bar)", "tooltip": True, "cornerRadiusEnd": 2},
            "encoding": {
                "y": {"field": "dof", "type": "nominal", "sort": None, "title": None, "axis": {**NAMES_AXIS}},
                "x": {"field": "rms_deg", "type": "quantitative", "title": "RMS error, degrees"},
                "tooltip": [
                    {"field": "dof", "title": "degree of freedom"},
                    {"field": "rms_deg", "title": "RMS, degrees", "format": ".2f"},
                    {"field": "pieces", "title": "actionlets"},
                    {"field": "ratio", "title": "times smaller", "format": ".1f"},
                ],
            },
            "config": NAMES_CONFIG,
        },
        data={"errors": data},
    )


def _place(dof: str) -> int:
    """Of a degree of freedom among the staves; those of a file stay in its order."""
    joint = dof.rpartition(".")[0]
    return _ORDER.index(joint) if joint in _ORDER else -1


def _drawn(found: Decomposed, shown: list[int]) -> dict[str, Any]:
    """What the script draws: a stave for each moving degree of freedom, of degrees and seconds."""
    recorded = found.recorded
    stride = max(1, round(recorded.fps / _DRAWN_FPS))
    frames = np.unique(np.append(np.arange(0, len(recorded.angles), stride), len(recorded.angles) - 1))
    staves = []
    for column in shown:
        dof = recorded.dofs[column]
        track = found.score[dof]
        joint, _, movement = dof.rpartition(".")
        pieces = [piece for piece in track.pieces if isinstance(piece, Actionlet)]
        staves.append(
            {
                "joint": joint.replace("_", " "),
                "movement": movement,
                "side": _SIDES[side_and_part(joint)[0]],
                "rms": round(float(found.rms_deg[column]), 3),
                "times": packed_array(track.times.astype(np.float32)),
                "angles": packed_array(np.degrees(track.extremes).astype(np.float32)),
                "skews": packed_array(np.array([piece.skew for piece in pieces], np.float32)),
                "recorded": steps(np.degrees(recorded.angles[frames, column])),
            }
        )
    return {
        "seconds": found.score.duration,
        "frames": packed_array(recorded.times[frames].astype(np.float32)),
        "staves": staves,
    }
