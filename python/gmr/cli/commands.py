"""The commands: each is a module here with a click command of its name, and one line in COMMANDS.

Command modules import NumPy and the rest of gmr inside their functions, so that help answers at once.
"""

from __future__ import annotations

import difflib
from importlib import import_module
from typing import Final

import click

__all__ = ["gmr"]

COMMANDS: Final = (
    "evaluate", "complete", "info", "convert", "roots", "view", "skin", "synthesize", "decompose",
    "bench", "demo",
)  # fmt: skip


class Commands(click.Group):
    """The commands, each imported when it is asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Their names, in the order in which a newcomer needs them."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of that name; None where there is none."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = getattr(import_module(f"gmr.cli.{cmd_name}"), cmd_name)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command that the first argument names; where there is none, a refusal with names near it."""
        name = args[0]
        if name not in COMMANDS and not name.startswith("-"):
            near = difflib.get_close_matches(name, COMMANDS, n=2)
            meant = f"Did you mean {' or '.join(near)}?" if near else f"There are {', '.join(COMMANDS)}."
            ctx.fail(f"No such command '{name}'. {meant}")
        return super().resolve_command(ctx, args)


@click.command(
    cls=Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Exit codes: 0 done, 1 some inputs failed (named on stderr), 2 wrong usage, 130 interrupted.",
)
@click.version_option(package_name="gmr-motion", prog_name="gmr")
def gmr() -> None:
    """Motion capture at memory speed: look into motions, convert them, measure what a set of them can do.

    \b
    gmr info walk.bvh             what is in a file, and what is odd about it
    gmr convert takes/ out/ --fps 60 --mirror
    gmr roots walk.bvh --set Hips,LeftHand,RightHand
    gmr skin figure.glb walk.bvh walking.glb       a motion drives a character
    gmr synthesize walk --speed 1.4 --out walk.bvh     a motion that nobody recorded
    gmr view walk.bvh --open                       look at it in a browser
    gmr decompose walk.bvh --out score.html        a motion as a score of single movements
    gmr evaluate takes/           what a set of locomotion clips can do, as a report
    gmr COMMAND --help            more examples
    """
