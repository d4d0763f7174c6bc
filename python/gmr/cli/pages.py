"""What ``gmr info`` prints for people: a page for a few files, a line each for many."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from os.path import commonpath
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from gmr.listing import listed

if TYPE_CHECKING:
    from gmr.description import Description

__all__ = ["overview", "page"]

FEW: Final = 6
"""Joints that a line names; the others it counts."""


def page(path: str, of: Description) -> str:
    """The description for people: a line for each thing, oddities last."""
    lines = [
        ("frames", _frames(of)),
        ("joints", _joints(of)),
        ("skeleton", of.asf or ""),
        ("roots", listed(of.roots, FEW) or "none"),
        ("moved", listed(of.configuration, FEW)),
        ("dummies", listed(of.dummies, 12) or "none"),
        ("channels", f"{of.channels} a frame: {_channels(of)}"),
        ("moving", f"position channels below the root: {listed(of.moving, FEW)}" if of.moving else ""),
        ("size", _size(of)),
        ("up", _up(of)),
        *(("odd", oddity) for oddity in of.oddities),
    ]
    body = "\n".join(f"  {key:<9} {text}" for key, text in lines if text)
    return f"{click.style(path, bold=True)}\n{body}"


def _frames(of: Description) -> str:
    if not of.fps:
        return f"{of.frames:,}, without a rate"
    return f"{of.frames:,} at {of.fps:.6g} fps: {of.seconds:.2f} s"


def _joints(of: Description) -> str:
    ends = f", {of.ends} of them end sites" if of.ends else ""
    return f"{len(of.joints)}{ends}"


def _channels(of: Description) -> str:
    counted = [f"{_short(order)} ({count})" for order, count in of.orders.items()]
    return listed(counted, 4) if counted else "none"


def _short(order: str) -> str:
    """ "Xposition Yposition Zrotation" as "XY positions, Z rotations"."""
    parts: list[tuple[str, str]] = []
    for channel in order.split():
        kind = channel[1:].lower()
        if parts and parts[-1][1] == kind:
            parts[-1] = (parts[-1][0] + channel[0], kind)
        else:
            parts.append((channel[0], kind))
    return " ".join(f"{axes} {kind}" for axes, kind in parts)


def _size(of: Description) -> str:
    if of.height is None:
        return "unknown: no frames"
    tall = f"{of.height:.4g} file units tall"
    if of.unit is not None:
        return f"{tall}, {of.height * of.unit:.2f} m"
    if of.unit_guess is None:
        return f"{tall}; no unit makes that a human"
    guess = of.unit_guess
    metres = f"{of.height * guess.metres:.2f} m if the unit is {guess.name} ({guess.metres:.4g} m)"
    return f"{tall}; {metres}: a guess from the {guess.by}"


def _up(of: Description) -> str:
    if of.up_guess is None:
        return ""
    reason = "from the feet up" if of.up_guess.sure else "the body's longest side: a weak guess"
    return f"{of.up_guess.axis}, {reason}"


def overview(found: Mapping[str, Description]) -> str:
    """A line for each motion, then what they have in common and what is odd about which."""
    base = _base(list(found))
    shown = {path: str(Path(path).relative_to(base)) if base else path for path in found}
    heads = ("file", "seconds", "frames", "fps", "joints", "size")
    rows = [heads] + [
        (shown[path], f"{of.seconds:.2f}", f"{of.frames:,}", f"{of.fps:.6g}", f"{len(of.joints)}", _tall(of))
        for path, of in found.items()
    ]
    widths = [max(len(row[k]) for row in rows) for k in range(len(heads))]
    lines = ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]) for row in rows]
    lines[0] = click.style(lines[0], bold=True)
    seconds, frames = (sum(getattr(of, key) for of in found.values()) for key in ("seconds", "frames"))
    lines += ["", f"{len(found)} motions in {base or '.'}: {frames:,} frames, {seconds:,.1f} s"]
    lines += _shared("unit", found, shown, lambda of: [_unit(of)])
    lines += _shared("up", found, shown, lambda of: [_up(of) or "unknown"])
    lines += _shared("skeleton", found, shown, lambda of: [of.asf] if of.asf else [])
    lines += _shared("roots", found, shown, lambda of: [listed(of.roots, FEW) or "none"])
    lines += _shared("dummies", found, shown, lambda of: [listed(of.dummies, 12) or "none"])
    lines += _shared("odd", found, shown, lambda of: of.oddities)
    return "\n".join(lines)


def _base(paths: list[str]) -> str:
    """The folder that all are in; "" where some are told from here and some from the top."""
    try:
        return commonpath([str(Path(path).parent) for path in paths])
    except ValueError:
        return ""


def _shared(
    key: str,
    found: Mapping[str, Description],
    shown: Mapping[str, str],
    facts: Callable[[Description], Sequence[str]],
) -> list[str]:
    """A line for each different fact, with the files that it is true of."""
    files: dict[str, list[str]] = {}
    for path, of in found.items():
        for fact in facts(of):
            files.setdefault(fact, []).append(shown[path])
    return [
        f"  {key:<9} {fact}" + ("" if len(who) == len(found) else f"  [{len(who)}: {listed(who, 3)}]")
        for fact, who in sorted(files.items(), key=lambda entry: -len(entry[1]))
    ]


def _tall(of: Description) -> str:
    if of.height is None:
        return "-"
    metres = of.unit or (of.unit_guess.metres if of.unit_guess else None)
    return f"{of.height:.4g}" + (f" = {of.height * metres:.2f} m" if metres else "")


def _unit(of: Description) -> str:
    if of.unit is not None:
        return f"{of.unit:g} m"
    if of.unit_guess is None:
        return "unknown: none makes that a human"
    return f"{of.unit_guess.name} ({of.unit_guess.metres:.4g} m), a guess from the {of.unit_guess.by}"
