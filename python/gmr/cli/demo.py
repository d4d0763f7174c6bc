"""``gmr demo``: the main job, on the clips that ship with gmr."""

from __future__ import annotations

from pathlib import Path

import click


@click.command(short_help="Evaluate the clips that ship with gmr.")
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    default=Path("gmr-demo/report.html"),
    show_default=True,
    help="Where the report goes.",
)
def demo(out: Path) -> None:
    """Evaluate the clips that ship with gmr: real walks and runs, and their mirrored copies.

    Does what `gmr evaluate FOLDER --mirror` does on a folder of your own.

    Exit codes: 0 done, 1 the report could not be written, 2 wrong usage, 130 interrupted.
    """
    from gmr.cli.evaluate import evaluate
    from gmr.demo import CREDIT, demo_folder

    folder = demo_folder()
    click.echo(f"Evaluating the {len(list(folder.glob('*.bvh')))} clips of real people that ship with gmr,")
    click.echo("and their mirrored copies, as a motion-matching dataset.\n")
    evaluate.main([str(folder), "--mirror", "--out", str(out)], standalone_mode=False)
    click.echo(f"\n{CREDIT}")
    click.echo("\nNext: gmr evaluate FOLDER, with a folder of your own BVH files.")
