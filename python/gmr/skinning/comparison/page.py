"""The comparison's page: words first, then the capsule, then the character, in pictures and figures."""

from __future__ import annotations

import base64
from collections.abc import Sequence

import numpy as np

from gmr.pages.document import element, section, text
from gmr.pages.figure import Figure
from gmr.pages.page import Page
from gmr.skinning.comparison.figures import capsule_figures, clip_figures
from gmr.skinning.comparison.measured import METHODS, Comparison
from gmr.skinning.comparison.pictures import Picture

__all__ = ["headline", "page"]

_LINEAR, _DUAL, _ = METHODS.values()


def page(of: Comparison, pictures: Sequence[Picture], film: bytes | None) -> str:
    """The page as HTML; ``film`` is an MP4."""
    capsule, clip = list(capsule_figures(of)), list(clip_figures(of))
    name = of.character.name
    return Page(
        title=f"{name}: skinning compared",
        eyebrow="Skinning compared",
        heading=f"{name}, {of.motion}" if of.motion else name,
        facts=_facts(of),
        sections="\n".join(
            [
                _verdict(of),
                section(
                    "character",
                    "The character in the clip",
                    "Frames in which the methods differ most, drawn to one scale.",
                    _film(film) + _pictures(pictures, "clip") + _figures(clip),
                ),
                section(
                    "capsule",
                    "The capsule",
                    "Two bones in a tube, bent and twisted: the methods alone, on no character's shape.",
                    _pictures(pictures, "capsule") + element("div", _figures(capsule), class_="pairs"),
                ),
                _method(of),
            ]
        ),
        figures=[*clip, *capsule],
    ).html()


def headline(of: Comparison) -> str:
    """What the comparison comes to, in a sentence."""
    kept = {m: of.frames["volume"][of.frames["method"] == m] for m in METHODS.values()}
    lost = {method: float(1 - volume.min()) for method, volume in kept.items()}
    far = float(of.apart["apart_max_mm"].max())
    return (
        f"Linear blending loses up to {lost[_LINEAR]:.1%} of the character's volume, dual quaternions "
        f"{lost[_DUAL]:.1%}; at most {far:.0f} mm lie between them."
    )


def _facts(of: Comparison) -> dict[str, str]:
    return {
        "vertices": f"{len(of.character.merged.vertices):,}",
        "joints": f"{len(of.character.joint_names):,}",
        "frames": f"{len(of.poses):,}",
        "seconds": f"{len(of.poses) * of.frame_time:.1f}",
    }


def _verdict(of: Comparison) -> str:
    apart = of.apart["apart_max_mm"]
    worst = int(np.argmax(apart))
    joints, counts = np.unique(of.apart["joint"].astype(str), return_counts=True)
    often = joints[np.argsort(-counts, kind="stable")][:3]
    said = [
        f"They differ most in frame {worst}, at {of.apart['seconds'][worst]:.2f} s, round "
        f"{of.apart['joint'][worst]}.",
        f"Over the clip the farthest vertex mostly follows {', '.join(often)}.",
        "Neither is right everywhere: linear blending collapses where a joint twists, dual quaternions bulge "
        "where it bends. Centres of rotation bulge less and do not collapse, but must be computed once.",
    ]
    body = element("h2", text(headline(of))) + element("ul", "".join(element("li", text(s)) for s in said))
    return element("section", body, id="verdict")


def _method(of: Comparison) -> str:
    closed = "has no hole" if of.is_closed else "has holes, closed flat to measure its volume"
    words = [
        "Volume: enclosed by the triangles, over that at rest (divergence theorem).",
        "Stretch: the logarithm of lengths and areas over those at rest, weighed by their size at rest.",
        f"The character's surface {closed}; vertices in one place count as one.",
        "Linear: sum of weighted transforms. Dual quaternion: Kavan et al. 2007, signs by the strongest "
        "joint. Centres of rotation: Le and Hodgins 2016.",
        "All numbers stand in frames.csv, apart.csv and capsule.csv beside this page.",
    ]
    return section(
        "method", "Method", "", element("ul", "".join(element("li", text(word)) for word in words))
    )


def _figures(figures: Sequence[Figure]) -> str:
    return "".join(
        element(
            "figure",
            element("figcaption", element("h3", text(figure.title)) + element("p", text(figure.sentence)))
            + element("div", "", class_="chart", data_figure=figure.name),
            class_="figure",
            id=figure.name,
        )
        for figure in figures
    )


def _pictures(pictures: Sequence[Picture], group: str) -> str:
    return "".join(
        element(
            "figure",
            element("figcaption", element("h3", text(picture.title)) + element("p", text(picture.caption)))
            + f'<img class="still" alt="{text(picture.caption)}" src="{_inlined("image/png", picture.png)}">',
            class_="figure",
        )
        for picture in pictures
        if picture.group == group
    )


def _film(film: bytes | None) -> str:
    if film is None:
        return ""
    video = (
        f'<video class="still" controls loop muted playsinline src="{_inlined("video/mp4", film)}"></video>'
    )
    caption = element("figcaption", element("h3", "Side by side, in real time"))
    return element("figure", caption + video, class_="figure")


def _inlined(kind: str, data: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"
