"""``gmr view``: motions and characters in a browser, live or as a page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

import click

from gmr.cli.characters import holds_character
from gmr.cli.common import STDIO, Failures, Rate, Unit, read_noting, reading_options, say

if TYPE_CHECKING:
    from gmr.skinning.character import Character
    from gmr.view.figure import Figure
    from gmr.view.stage import Look

__all__ = ["view"]

LARGE: Final = 10_000_000
"""Bytes of a page that are worth a word."""


@click.command(short_help="Look at motions and characters in a browser.")
@click.argument("files", metavar="FILE...", nargs=-1, required=True)
@click.option(
    "--character", "skin", metavar="GLB", type=click.Path(), help="A skin for the motions, which drive it."
)
@click.option(
    "--save",
    "page",
    metavar="HTML",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write one page that plays offline, instead of serving.",
)
@click.option("--fps", type=Rate(), help="Frames a second of the page, at the most.  [default: 30]")
@click.option(
    "--port", type=click.IntRange(1, 65535), help="Where to serve.  [default: the first free from 8080]"
)
@click.option("--open", "opens", is_flag=True, help="Open the browser.")
@click.option(
    "--blending",
    type=click.Choice(["lbs", "dqbs", "cor"]),
    default="lbs",
    show_default=True,
    help="Skins by linear or dual quaternion blending, or by optimised centres of rotation.",
)
@click.option("--weights", metavar="JOINT", help="Colour skins by how much they follow this joint.")
@click.option(
    "--hide",
    type=click.Choice(["skeleton", "skin", "trails", "names"]),
    multiple=True,
    help="Leave this out. Repeatable.",
)
@click.option(
    "--bones",
    "rule",
    type=click.Choice(["per_child", "first_child", "centroid"]),
    default="per_child",
    show_default=True,
    help="Which way bones are drawn.",
)
@click.option(
    "--opacity",
    type=click.FloatRange(0.1, 1.0),
    default=1.0,
    show_default=True,
    help="Of skins; below 1 bones are seen in them.",
)
@click.option("--overlay", is_flag=True, help="Everything where it is, not side by side.")
@click.option(
    "--unit", type=Unit(), help="Unit of length of the motions: m, cm, mm, in, ft, cmu, or metres per unit."
)
@reading_options
def view(
    files: tuple[str, ...],
    skin: str | None,
    page: Path | None,
    fps: float | None,
    port: int | None,
    opens: bool,
    blending: str,
    weights: str | None,
    hide: tuple[str, ...],
    rule: str,
    opacity: float,
    overlay: bool,
    unit: float | None,
    positions: str,
    asf: str | None,
    amc_fps: float | None,
    animation: str | None,
    strict: bool,
) -> int:
    """Look at motions (BVH, AMC, GMR, GLTF) and characters in a browser, side by side.

    A local server shows them until Ctrl-C: with a time line, play and pause, single frames, speed, the ways
    of root and hands, and skins blended in three ways or coloured by weights. With --save they go into one
    HTML file that plays without a server or a network.

    \b
    Examples:
      gmr view walk.bvh --open
      gmr view before.bvh after.bvh --overlay       two versions of one take in one place
      gmr view figure.glb --blending dqbs
      gmr view walk.bvh --character figure.glb
      gmr view walk.bvh --save walk.html            to send to somebody

    Exit codes: 0 the page is written, 1 some files could not be shown (they are named), 2 wrong usage, 130
    ended by Ctrl-C.
    """
    if page is None and fps is not None:
        raise click.UsageError("--fps is for a page; give --save too")
    if page is not None and (port is not None or opens):
        raise click.UsageError("--save writes a page and serves nothing; leave out --port and --open")
    from gmr.view.stage import LAYERS, Look

    look = Look(cast(Any, blending), weights, frozenset(LAYERS) - set(hide), opacity, overlay)
    reading = {"positions": positions, "asf": asf, "fps": amc_fps, "animation": animation, "strict": strict}
    failures = Failures()
    character = None if skin is None else _character(skin, strict)
    figures = []
    for file in files:
        with failures.of(file):
            figures.append(_figure(file, character, rule, unit, reading))
    if not figures:
        return 1
    for figure in figures:
        for note in figure.notes:
            say(f"{figure.name}: {note}")
    _check_weights(weights, figures)
    if page is not None:
        _save(figures, page, look, fps)
    else:
        _serve(figures, look, port, opens)
    return failures.exit_code()


def _figure(
    file: str, character: Character | None, rule: str, unit: float | None, reading: dict[str, Any]
) -> Figure:
    from gmr.view.figure import motion_figure, posed_figure

    name = "<stdin>" if file == STDIO else Path(file).name
    if holds_character(file):
        animation = reading["animation"]
        found = _character(file, reading["strict"])
        return posed_figure(found, animation=0 if animation is None else animation, rule=rule, name=name)
    motion, warnings = read_noting(file, **reading)
    for warning in warnings:
        say(warning)
    return motion_figure(motion, character, rule=rule, unit=unit, name=name)


def _character(path: str, strict: bool) -> Character:
    import warnings

    from gmr.errors import FormatWarning
    from gmr.formats import read_character

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", FormatWarning)
        character = read_character(path, strict=strict)
    for warning in caught:
        say(str(warning.message))
    return character


def _check_weights(joint: str | None, figures: list[Figure]) -> None:
    """Raises unless some skin has the joint whose weights are asked for."""
    from gmr.errors import GmrError
    from gmr.view.patches import joint_weights

    skins = [figure.worn.character for figure in figures if figure.worn is not None]
    if joint is None or any(joint in skin.joint_names for skin in skins):
        return
    if not skins:
        raise GmrError(
            f"nothing here has a skin, so the weights of '{joint}' cannot be shown; give --character"
        )
    joint_weights(skins[0], joint)


def _save(figures: list[Figure], path: Path, look: Look, fps: float | None) -> None:
    from gmr.errors import GmrError
    from gmr.replacing import check_place
    from gmr.view.saving import FPS, save

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        check_place(path)
        page = save(figures, path, look=look, fps=FPS if fps is None else fps)
    except OSError as error:
        raise GmrError(f"{path}: {error.strerror or error}") from error
    size = len(page.text.encode())
    click.echo(f"{path}: {page.seconds:.2f} s at {page.fps:.6g} frames a second, {size / 1e6:.1f} MB")
    if size > LARGE:
        less = max(1, round(page.fps / 3))
        say(f"that is large; a lower rate (--fps {less}) or --blending lbs makes it smaller")


def _serve(figures: list[Figure], look: Look, port: int | None, opens: bool) -> None:
    from gmr.view.server import show

    with show(figures, look=look, port=port, open=opens) as live:
        click.echo(f"{live.address} shows {len(figures)} of them; Ctrl-C ends it" if len(figures) > 1
                   else f"{live.address} shows {figures[0].name}; Ctrl-C ends it")  # fmt: skip
        live.wait()
