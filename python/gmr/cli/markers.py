"""What ``gmr info`` and ``gmr convert`` do with recordings of markers."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click

from gmr.cli.common import options_given, say
from gmr.listing import listed, quoted

if TYPE_CHECKING:
    from gmr.markers import MarkerFit, Markers
    from gmr.markers.description import MarkerDescription
    from gmr.motion import Motion

__all__ = ["Fitting", "fitting_options", "marker_json", "marker_page"]

Command = TypeVar("Command", bound=Callable[..., Any])

FEW: Final = 6
"""Names, gaps or parts that a line lists; the others it counts."""


class Picture(click.ParamType[Path]):
    """Where to draw an SVG."""

    name = "FILE.svg"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The place."""
        path = Path(value)
        if path.suffix.lower() != ".svg":
            self.fail(f"the picture is an SVG; give a name that ends with .svg, not '{value}'", param, ctx)
        return path


@dataclass(frozen=True)
class Fitting:
    """How markers are to become a motion.

    Args:
        relation: name or file of a relation; None: the one that fits.
        subject: prefix of the labels of the person meant.
        max_gap: seconds of a part not being seen that are bridged.
        undo_swaps: whether exchanged labels are put right first.
        known_only: whether only the longest stretch is written in which all parts are known.
        picture: where to draw a film strip; None: nowhere.
        as_json: whether the report of the fit is printed as JSON.
        given: the options on the command line that say nothing of other inputs.
    """

    relation: str | None
    subject: str | None
    max_gap: float
    undo_swaps: bool
    known_only: bool
    picture: Path | None
    as_json: bool
    given: tuple[str, ...] = ()

    def check_unneeded(self, motion: Motion) -> None:
        """Refuses options for markers where the input is a motion already.

        Raises:
            UsageError: some were given.
        """
        if self.given:
            alone = len(self.given) == 1
            what = (
                f"{listed(self.given, FEW)} {'is' if alone else 'are'} for recordings of markers (C3D) only"
            )
            advice = f"leave {'it' if alone else 'them'} out"
            raise click.UsageError(f"{what}, but '{motion.name}' holds a motion; {advice}")

    def motion(self, markers: Markers) -> Motion:
        """The motion that a recording becomes; what there is to say of it is said.

        Raises:
            GmrError: it cannot be, or parts are not seen for long and nobody said what then.
        """
        if self.undo_swaps:
            markers = markers.undo_swaps(markers.findings(self.relation))
            for sentence in markers.history:
                say(f"{markers.name}: {sentence}")
        fit = markers.fit(self.relation, subject=self.subject, max_gap=self.max_gap)
        if self.as_json:
            click.echo(json.dumps({"file": markers.name, **fit.report.as_dict()}, indent=2, allow_nan=False))
        else:
            _say_fit(fit)
        if self.picture is not None:
            _draw(fit, self.picture)
        return _known(fit, self.known_only)


def fitting_options(command: Command) -> Command:
    """The options of a command that says how markers become a motion; it is called with ``fitting``."""
    import functools

    options = (
        click.option("--relation", metavar="NAME|FILE", help="C3D: which marker is on which part: ior, "
                     "plug_in_gait or a file; told by the labels otherwise."),
        click.option("--subject", help="C3D: the person meant, where labels begin with a name (Anna:LASI)."),
        click.option("--max-gap", type=click.FloatRange(min=0), default=0.2, show_default=True,
                     metavar="SECONDS", help="C3D: bridge parts that are not seen for so long."),
        click.option("--undo-swaps", is_flag=True, help="C3D: put exchanged labels right first."),
        click.option("--known-only", is_flag=True,
                     help="C3D: write only the longest stretch in which every part is known."),
        click.option("--picture", type=Picture(), metavar="FILE.svg",
                     help="C3D: draw markers and skeleton in some frames."),
        click.option("--json", "as_json", is_flag=True, help="Print JSON: which files were written and which "
                     "failed; for C3D, how well the markers fit."),
    )  # fmt: skip

    @functools.wraps(command)
    def taking(**values: Any) -> Any:
        keys = ("relation", "subject", "max_gap", "undo_swaps", "known_only", "picture")
        chosen = {key: values.pop(key) for key in keys}
        fitting = Fitting(**chosen, as_json=values.pop("as_json"), given=options_given(*keys))
        return command(fitting=fitting, **values)

    wrapped: Any = taking
    for option in reversed(options):
        wrapped = option(wrapped)
    return wrapped  # type: ignore[no-any-return]


def marker_page(path: str, of: MarkerDescription) -> str:
    """The description for people: a line for each thing, oddities last."""
    lines = [
        ("frames", _frames(of)),
        ("markers", _markers(of)),
        ("unit", "unknown" if of.unit is None else f"{of.unit:g} m"),
        ("up", _up(of)),
        ("events", _events(of)),
        ("besides", f"{', '.join(of.ignored)}: not read" if of.ignored else ""),
        ("gaps", _gaps(of)),
        ("set", _set(of)),
        *(("odd", oddity) for oddity in of.oddities),
    ]
    body = "\n".join(f"  {key:<9} {text}" for key, text in lines if text)
    return f"{click.style(path, bold=True)}\n{body}"


def marker_json(of: MarkerDescription) -> dict[str, Any]:
    """The description as JSON has it."""
    return {**asdict(of), "marker_count": len(of.labels)}


def _frames(of: MarkerDescription) -> str:
    if not of.fps:
        return f"{of.frames:,}, without a rate"
    return f"{of.frames:,} at {of.fps:.6g} fps: {of.seconds:.2f} s"


def _markers(of: MarkerDescription) -> str:
    return f"{len(of.labels)}: {listed(of.labels, FEW)}" if of.labels else "none"


def _up(of: MarkerDescription) -> str:
    if of.up is not None:
        return f"{of.up.axis}, {of.up.by}"
    return "unknown; the body tells it when it is fitted" if of.relation else "unknown"


def _events(of: MarkerDescription) -> str:
    return listed([f"{event.label} {event.seconds:.2f} s" for event in of.events], FEW)


def _gaps(of: MarkerDescription) -> str:
    if not of.gaps:
        return "none"
    frames = sum(gap.length for gap in of.gaps)
    part = frames / max(1, of.frames * len(of.labels))
    longest = max(of.gaps, key=lambda gap: gap.length)
    said = f"{len(of.gaps)}, {part:.1%} of all places; the longest is '{longest.marker}' from frame "
    said += f"{longest.first}, {longest.length:,} frames"
    return said + (f"; never seen: {quoted(of.never_seen, FEW)}" if of.never_seen else "")


def _set(of: MarkerDescription) -> str:
    if of.relation is None:
        return "none that gmr knows; write a relation to make a motion of it" if of.labels else ""
    fit = of.relation
    said = f"{fit.name}: {fit.found} of {fit.found + len(fit.missing)} markers"
    if fit.missing:
        each = [name + (f" ({quoted(near, 2)}?)" if near else "") for name, near in fit.missing.items()]
        said += f", without {listed(each, FEW)}"
    return said + (f"; not in it: {listed(fit.left_over, FEW)}" if fit.left_over else "")


def _say_fit(fit: MarkerFit) -> None:
    """The fit in a few lines on stderr."""
    report, name = fit.report, fit.markers.name
    worst = max(report.parts, key=lambda part: part.worst)
    say(
        f"{name}: {report.relation}: {len(report.parts)} parts; markers are {report.mean:.1f} mm off rigid "
        f"parts in the mean, {worst.worst:.0f} mm at most ('{worst.worst_marker}', frame {worst.worst_frame})"
    )
    for note in report.notes:
        say(f"{name}: {note}")
    for part, why in report.left_out.items():
        say(f"{name}: {part} is left out: {why}")
    if report.missing:
        verb = "is" if len(report.missing) == 1 else "are"
        say(f"{name}: {_missing(report.missing)} {verb} not in the recording")
    bridged = sum(stretch.became == "bridged" for part in report.parts for stretch in part.stretches)
    if bridged:
        say(f"{name}: {bridged} short stretches in which a part is not seen are bridged")


def _missing(missing: Mapping[str, tuple[str, ...]]) -> str:
    """Markers of a relation that are not there; first those that are nearly called as one that is, for these
    may be misspelt."""
    each = [
        f"'{label}'" + (f" (did you mean {quoted(near, 2)}?)" if near else "")
        for label, near in sorted(missing.items(), key=lambda entry: not entry[1])
    ]
    return listed(each, FEW)


def _known(fit: MarkerFit, known_only: bool) -> Motion:
    """The motion, all of which is known."""
    import numpy as np

    from gmr.errors import GmrError
    from gmr.markers.gaps import runs

    if not fit.unknown:
        return fit.motion
    whole = np.ones(fit.motion.frame_count, bool)
    for stretches in fit.unknown.values():
        for stretch in stretches:
            whole[stretch.first : stretch.first + stretch.length] = False
    first, length = max(runs(whole), key=lambda run: run[1], default=(0, 0))
    if known_only and length:
        say(f"{fit.markers.name}: frames {first} to {first + length - 1} are written, in which all is known")
        return fit.motion[first : first + length]
    part, stretches = next(iter(fit.unknown.items()))
    frames = [f"{each.first} to {each.first + each.length - 1}" for each in stretches]
    others = f", nor {listed(list(fit.unknown)[1:], FEW)} in others" if len(fit.unknown) > 1 else ""
    advice = "Write only what is known (--known-only), or bridge more (--max-gap); nothing bridges an edge."
    if known_only:
        advice = "There is no frame in which every part is known."
    raise GmrError(
        f"{fit.markers.name}: '{part}' is not seen in frames {listed(frames, FEW)}{others}. {advice}"
    )


def _draw(fit: MarkerFit, path: Path) -> None:
    from gmr.errors import GmrError
    from gmr.replacing import replacing

    try:
        with replacing(path) as (file,):
            file.write(fit.picture().encode())
    except OSError as error:
        raise GmrError(f"{path}: cannot be written: {error.strerror}") from error
