"""``gmr synthesize``: motions made of actionlets, by the name of the action."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gmr.cli.common import STDIO, Rate, say, write_output
from gmr.cli.corpus import Several, corpus, corpus_options, refuse_corpus_options

if TYPE_CHECKING:
    from gmr.actionlets.actions.library import Library
    from gmr.actionlets.actions.taking import Take
    from gmr.actionlets.actions.timeline import Profile

__all__ = ["Setting", "made", "synthesize"]


class Setting(click.ParamType[tuple[str, "Profile"]]):
    """A parameter and its value, or the values that it goes through: ``speed=1.2``, ``speed=0:0.8,4:2``."""

    name = "NAME=VALUE"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, Profile]:
        """The name, and a number or (seconds, number) points."""
        if isinstance(value, tuple):
            return value
        name, equals, said = value.partition("=")
        points = [point.split(":") for point in said.split(",")]
        try:
            if not equals or not name.strip():
                raise ValueError
            if len(points) == 1 and len(points[0]) == 1:
                return name.strip(), float(said)
            return name.strip(), [(float(seconds), float(number)) for seconds, number in points]
        except ValueError:
            self.fail(
                f"'{value}' sets nothing; write speed=1.2, or speed=0:0.8,4:2 for one that changes: "
                "seconds:value, with commas between",
                param,
                ctx,
            )


@click.command(short_help="Make a motion that nobody recorded.")
@click.argument("action", required=False, metavar="ACTION[,ACTION...]")
@click.option(
    "--out", metavar="FILE|FOLDER", help="Where to write the motion, by suffix, - is standard output (BVH); "
    "or the corpus.",
)  # fmt: skip
@click.option("--list", "is_list", is_flag=True, help="Print the actions, their parameters and ranges.")
@click.option("--seconds", type=Several(click.FLOAT), help="How long; as the action says otherwise.")
@click.option("--fps", type=Rate(), default=120.0, show_default=True, help="Frames a second.")
@click.option("--speed", type=Several(click.FLOAT), help="Metres a second: --set speed=...")
@click.option(
    "--turn-rate", type=Several(click.FLOAT), help="Degrees a second, to the left: --set turn_rate=..."
)
@click.option(
    "--set", "settings", type=Several(Setting()), multiple=True, help="Any parameter of the action."
)
@click.option("--seed", type=int, default=0, show_default=True, help="Which performer, of those that vary.")
@click.option(
    "--variation", type=Several(click.FLOAT),
    help="How much performers vary: 0 (as written) to 1.  [default: 0; of a corpus: 0..1]",
)  # fmt: skip
@click.option("--height", type=Several(click.FLOAT), help="Of the body, metres [1.75].")
@click.option(
    "--sex", type=Several(click.Choice(["male", "female", "average"])), default="average",
    show_default=True, help="Whose proportions and masses it has.",
)  # fmt: skip
@click.option(
    "--library", "files", type=click.Path(), multiple=True, help="Your own file of actions; repeatable."
)
@click.option("--strip", type=click.Path(path_type=Path), help="Draw a film strip too, .png or .svg.")
@corpus_options
def synthesize(
    action: str | None,
    out: str | None,
    is_list: bool,
    strip: Path | None,
    files: tuple[str, ...],
    variations: int | None,
    suffix: str,
    workers: int | None,
    cluster: str | None,
    as_json: bool,
    quiet: bool,
    **options: Any,
) -> int:
    """Make a motion of an action of the library.

    \b
    gmr synthesize walk --out walk.bvh --speed 1.4 --turn-rate 20 --seconds 6
    gmr synthesize walk --out faster.bvh --set speed=0:0.8,5:2
    gmr synthesize wave --out wave.glb --variation 0.5 --seed 7 --strip wave.png
    gmr synthesize --list                            the actions, with parameters and ranges
    gmr synthesize limp --library mine.toml --out limp.bvh

    The same arguments make the same motion.

    With --variations it makes a corpus: labelled takes in a folder, a manifest, on all cores or a cluster.
    A value may then be drawn from a range, 0.8..1.6, or taken in turn, 0.8,1.2,1.6; parameters that are not
    set are drawn from all of theirs. Stopped at any moment, the same command goes on.

    \b
    gmr synthesize walk,run --variations 1000 --out corpus/
    gmr synthesize walk --variations 600 --out paces/ --set speed=0.8,1.2,1.6 --height 1.5..1.9
    gmr synthesize walk,run --variations 100000 --out big/ --cluster tcp://10.0.0.1:8786

    Exit codes: 0 done, 1 the motion, or some takes of a corpus, could not be made, 2 wrong usage, 130
    interrupted.
    """
    from gmr.actionlets import library

    if action is None and not is_list:
        raise click.UsageError("name an ACTION, or give --list to see them")
    if variations is not None and not is_list:
        if strip is not None or out in (None, STDIO):
            raise click.UsageError("a corpus is written into a folder; give --out FOLDER, and no --strip")
        return corpus(
            str(action).split(","), variations, Path(str(out)), suffix, files,
            workers=workers, cluster=cluster, as_json=as_json, quiet=quiet, **options,
        )  # fmt: skip
    if action is not None and not is_list:
        if out is None and strip is None:
            raise click.UsageError("give --out FILE, --strip FILE or both")
        refuse_corpus_options()
        if "," in action:
            raise click.UsageError(
                f"'{action}' are several actions; give --variations N, which makes N takes of each"
            )
    known = library(*files)
    if is_list:
        click.echo("\n".join(_listed(known)))
        return 0
    take = made(known, str(action), **options)
    if strip is not None:
        _draw(take, strip)
    if out is not None:
        beside = write_output(take.motion, out if out == STDIO else Path(out))
        say(f"{out}: {take.motion.frame_count} frames, {take.performance.seconds:.3g} s of '{action}'")
        for file in beside:
            say(f"{file} was written beside")
    return 0


def made(
    known: Library,
    action: str,
    *,
    seconds: float | None,
    fps: float,
    speed: float | None,
    turn_rate: float | None,
    settings: tuple[tuple[str, Profile], ...],
    seed: int,
    variation: float | None,
    height: float | None,
    percentile: float | None,
    sex: str,
    body: str,
) -> Take:
    """The take that the command's options ask for."""
    from gmr.actionlets import Body
    from gmr.actionlets.actions.taking import check_frames, taken

    own = [(name, value) for name, value in (("speed", speed), ("turn_rate", turn_rate)) if value is not None]
    chosen: dict[str, Profile] = {}
    for name, value in (*settings, *own):
        if name in chosen:
            raise click.UsageError(f"'{name}' is set twice; say which it is")
        chosen[name] = value
    who = Body.of(height, sex, percentile, detailed=body == "detailed")
    check_frames(action, seconds or 0.0, fps)
    return taken(known[action].perform(chosen, seconds, seed, variation or 0.0), who, fps)


def _draw(take: Take, strip: Path) -> None:
    from gmr.actionlets import film_strip

    name = take.performance.action
    side = film_strip(take.motion, strip, titles=[name])
    say(f"{strip}: a film strip of '{name}', {len(side):,} bytes of SVG")


def _listed(known: Library) -> list[str]:
    """Two lines and more an action: what it is, its other names, and each parameter's range."""
    width = max(len(name) for name in known) + 2
    lines = []
    for name in known:
        action = known[name]
        also = f" (also: {', '.join(action.aliases)})" if action.aliases else ""
        lines.append(f"{name:{width}}{action.about}{also}")
        for parameter in action.parameters.values():
            unit = f" {parameter.unit}" if parameter.unit else ""
            spread = f"{parameter.low:g} to {parameter.high:g}{unit} [{parameter.default:g}]"
            lines.append(f"{'':{width}}{parameter.name:<11}{spread:<28}{parameter.about}".rstrip())
    return lines
