"""How the figures of the report were measured: terms, settings, and what was found in the files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from gmr.evaluation.result import Summary
from gmr.pages.document import element, text

__all__ = ["SOURCE", "terms"]

SOURCE: Final = (
    "After Abichequer Sangalli, Hoyet, Christie and Pettré, “A new framework for the evaluation of "
    "locomotive motion datasets through motion matching techniques”, MIG 2022, with its printed formulas "
    "corrected."
)
_TERMS: Final = {
    "Offset": "distance on the ground between the character and the planned position at the same time",
    "Speed error, turn rate error": "mean of what was played minus what was asked for; ± is the standard "
    "deviation over the trial",
    "Coverage": "speed and net turn of windows of one second, moved frame by frame, never across clips",
    "Jump": "the next frame shown is not the next of the clip; forced where the clip was over",
    "Foot slide": "way along the ground of the ball of a foot (the ankle where there are no toes) while the "
    "clips have it down, summed over a stance; the way is measured over a twelfth of a second, so that a toe "
    "that trembles on the spot does not count as sliding",
    "Jerk": "mean over the joints of the third difference of their places at {rate:g} frames per second, the "
    "largest of the three that reach over a step; of the same motion at twice the rate it may be some times "
    "as large, for noise of single frames grows with the cube of the rate",
    "Pose gap": "mean distance between the joints of the pose left and of the pose entered, before smoothing",
}


def terms(summary: Summary) -> str:
    """Terms of the metrics, the joints that were found, and every setting, as a description list."""
    described = {
        **{name: term.format(rate=summary.rate) for name, term in _TERMS.items()},
        "Unit of the files": summary.unit,
        "Joints found": ", ".join(f"{_words(role)}: {name}" for role, name in summary.joints.items()),
        **{_words(name).capitalize(): _setting(value) for name, value in summary.settings.items()},
    }
    rows = "".join(
        element("dt", text(name)) + element("dd", text(value)) for name, value in described.items()
    )
    return element("dl", rows, class_="plain")


def _words(name: str) -> str:
    unit = ", deg/s" if "rate" in name else ", degrees"
    return name.removesuffix("_deg").replace("_", " ") + (unit if name.endswith("_deg") else "")


def _setting(value: Any) -> str:
    match value:
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:g}"
        case Mapping():
            return "; ".join(f"{_words(str(name))}: {_setting(part)}" for name, part in value.items())
        case list() | tuple():
            return ", ".join(_setting(part) for part in value)
        case None:
            return "none"
        case _:
            return str(value)
