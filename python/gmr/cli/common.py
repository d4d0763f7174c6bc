"""What commands share: how they end, what they say on stderr, how they find their inputs."""

from __future__ import annotations

import io
import os
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO, TypeVar, cast

import click

from gmr.errors import FormatWarning, GmrError
from gmr.unbuffered import Whole

if TYPE_CHECKING:
    from gmr.formats.registry import Format
    from gmr.motion import Motion

__all__ = [
    "Failures",
    "Rate",
    "Unit",
    "files_of",
    "finished",
    "naming",
    "options_given",
    "progress",
    "read_input",
    "read_noting",
    "reading_options",
    "say",
    "write_output",
]

Item = TypeVar("Item")

STDIO = "-"
INTERRUPTED = 130

_bars: list[object] = []
"""Bars on stderr that have not come to their ends."""


def finished(command: click.Command, args: list[str] | None = None) -> int:
    """Runs a command and tells its exit code; every expected trouble is one sentence on stderr."""
    _open_closed_streams()
    given = sys.stdout
    sys.stdout = _with_whole_writes(given)
    try:
        code = command.main(args, standalone_mode=False)
        sys.stdout.flush()
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except (click.Abort, KeyboardInterrupt):
        say("interrupted; no file was left half-written")
        return INTERRUPTED
    except BrokenPipeError:
        _forget_output()
        return 1
    except GmrError as error:
        say(str(error))
        return 1
    except ImportError as error:
        if error.name is not None:
            raise  # a module is missing: a fault of the installation, to be seen with all that led to it
        # The core itself refuses: GMR_ISA asks for what this machine has not.
        say(str(error))
        return 1
    except OSError as error:
        say(f"{error.filename or 'standard output'}: {error.strerror}")
        if error.filename is None:
            _forget_output()
        return 1
    except MemoryError:
        say("this does not fit into the memory of this machine; give less at a time")
        return 1
    finally:
        sys.stdout = given
    return code if isinstance(code, int) else 0


def _open_closed_streams() -> None:
    """A standard stream that the caller has closed is empty or goes nowhere; Python has None in its place."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open(mode))  # noqa: SIM115  (open as long as the program)


def _forget_output() -> None:
    """What standard output did not take goes nowhere; Python would try, and complain, while it shuts down."""
    with suppress(OSError):  # a stream without a file behind it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _with_whole_writes(stream: TextIO) -> TextIO:
    """The stream; where Python runs unbuffered, one that does not lose the end of a text unnoticed."""
    raw = getattr(stream, "buffer", None)
    if not isinstance(raw, io.RawIOBase):
        return stream
    return io.TextIOWrapper(cast(Any, Whole(raw)), stream.encoding, stream.errors, write_through=True)


def say(sentence: str) -> None:
    """One sentence on stderr, in the place of a bar that has not come to its end; the bar goes on below."""
    rewind = "\r\x1b[K" if _bars else ""
    click.echo(f"{rewind}gmr: {sentence}", err=True)


class Unit(click.ParamType[float]):
    """A unit of length, by its name or in metres."""

    name = "UNIT"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Metres per unit."""
        from gmr.units import metres_per_unit

        try:
            return metres_per_unit(value)
        except GmrError as error:
            self.fail(str(error), param, ctx)


class Rate(click.ParamType[float]):
    """Frames a second, above 0."""

    name = "FPS"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Frames a second."""
        try:
            rate = float(value)
        except ValueError:
            self.fail(f"'{value}' is no number of frames a second", param, ctx)
        if not 0 < rate < float("inf"):
            self.fail(f"{value} frames a second cannot be; give a rate above 0", param, ctx)
        return rate


def reading_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Options of a command that reads files: ``positions``, ``asf``, ``amc_fps``, ``animation`` and
    ``strict``."""
    options = (
        click.option(
            "--positions", type=click.Choice(["replace", "add"]), default="replace", show_default=True,
            help="BVH: what position channels do to a joint's OFFSET.",
        ),
        click.option("--asf", type=click.Path(), help="AMC: the skeleton, where it is not beside."),
        click.option("--amc-fps", type=Rate(), help="AMC: frames a second, where it does not say [120]."),
        click.option("--animation", help="glTF: the name of the animation; the first otherwise."),
        click.option("--strict", is_flag=True, help="Refuse what is otherwise read with a note."),
    )  # fmt: skip
    for option in reversed(options):
        command = option(command)
    return command


class Failures:
    """The inputs that failed, each named on stderr as it happens."""

    def __init__(self) -> None:
        self.errors: dict[str, str] = {}

    @contextmanager
    def of(self, name: str) -> Iterator[None]:
        """Work on the input ``name``; an error that gmr raises is said, kept, and passed over."""
        try:
            yield
        except GmrError as error:
            self.errors[name] = str(error)
            say(str(error))

    def exit_code(self) -> int:
        """1 where an input failed, else 0."""
        return 1 if self.errors else 0


def files_of(path: str) -> list[Path | str]:
    """The files that an argument means: itself, ``-``, or for a folder all motions in it; recordings of
    markers in it are said to be left out.

    Raises:
        GmrError: a folder without motions.
    """
    if path == STDIO or not Path(path).is_dir():
        return [path]
    from gmr.formats.folder import left_out_markers, motion_files
    from gmr.formats.registry import suffixes

    found, left_out = motion_files(path), left_out_markers(path)
    if not found:
        known = ", ".join(suffixes("motion"))
        nothing = f"{path}: no motion in this folder or those below ({known})"
        raise GmrError(f"{nothing}; {left_out}" if left_out else nothing)
    if left_out:
        say(f"{path}: {left_out}")
    return [Path(path, file) for file in found]


def read_input(path: Path | str, **options: Any) -> Motion:
    """The motion of a file, or of standard input for ``-``; options that its format does not know are passed
    over, for they may be meant for others."""
    from gmr.formats.reading import given_options, read_with

    strict = options.pop("strict", False)
    given = given_options(
        options.pop("positions", "replace"),
        options.pop("asf", None),
        options.pop("fps", None),
        options.pop("animation", None),
    )
    if path == STDIO:
        return read_with(sys.stdin.buffer, given, strict=strict).with_name("<stdin>")
    return read_with(path, given, strict=strict)


def read_noting(path: Path | str, **options: Any) -> tuple[Motion, list[str]]:
    """The motion, and the oddities of its file that reading warned of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", FormatWarning)
        motion = read_input(path, **options)
    return motion, [str(warning.message) for warning in caught if issubclass(warning.category, FormatWarning)]


@contextmanager
def progress(items: Iterable[Item], label: str) -> Iterator[Iterable[Item]]:
    """The items, counted by a bar on stderr where someone watches and there are several."""
    held = list(items)
    if len(held) < 2 or not sys.stderr.isatty():
        yield held
        return
    with click.progressbar(held, label=label, file=sys.stderr) as bar:
        _bars.append(bar)
        try:
            yield bar
        finally:
            _bars.remove(bar)


@contextmanager
def naming(motion: Motion) -> Iterator[None]:
    """An error about joints or frames names the motion too."""
    try:
        yield
    except GmrError as error:
        if str(motion.name) in str(error):
            raise
        raise GmrError(f"{motion.name}: {error}") from error


def write_output(motion: Motion, out: Path | str, format: str | None = None) -> list[str]:
    """Writes a motion. Makes folders where none are.

    Args:
        motion: what to write.
        out: a file, or ``-`` for standard output.
        format: the name of the format to write; None: told by the suffix, and BVH for ``-``.

    Returns:
        The file that was written beside, if one was.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", FormatWarning)
        second = _written(motion, out, format)
    for warning in caught:
        say(str(warning.message))
    return second


def _written(motion: Motion, out: Path | str, format: str | None) -> list[str]:
    from gmr.cli.lost_roots import lost_roots
    from gmr.formats import write
    from gmr.formats.registry import FORMATS, format_of_file, named_format

    if format is not None:
        chosen = named_format(format)
    else:
        chosen = FORMATS[0] if out == STDIO else format_of_file(str(out), written=True)
    if out == STDIO:
        write(motion, sys.stdout.buffer, chosen.name)
        sys.stdout.buffer.flush()
        second = None
    else:
        _write_file(motion, out, chosen)
        second = chosen.place_beside(Path(out))
    if lost := lost_roots(motion, chosen):
        say(f"{'standard output' if out == STDIO else out}: {lost}")
    if chosen.name == "ASF" and out != STDIO and motion.frame_count:
        say(f"{out} holds the skeleton alone; write an .amc for the frames")
    return [] if second is None else [str(second)]


def _write_file(motion: Motion, out: Path | str, chosen: Format) -> None:
    from gmr.formats import write

    if isinstance(out, Path):
        try:
            out.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise GmrError(f"{out}: its folder cannot be made: {error.strerror}") from error
    write(motion, out, chosen.name)


def options_given(*names: str) -> tuple[str, ...]:
    """Those of a command's options that were not left to their defaults, as they are written."""
    context = click.get_current_context()
    default = click.core.ParameterSource.DEFAULT
    return tuple(
        f"--{name.replace('_', '-')}" for name in names if context.get_parameter_source(name) is not default
    )
