"""``gmr decompose``: a recorded motion becomes a score of actionlets."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from gmr.cli.common import naming, read_noting, reading_options, say

if TYPE_CHECKING:
    from gmr.actionlets import Body
    from gmr.actionlets.decomposition import Decomposed

__all__ = ["decompose"]

_HEADS: Final = (("most", 6), ("from", 7), ("to", 7), ("pieces", 6), ("still", 5), ("ratio", 6))


@click.command(short_help="Take a motion apart into actionlets; draw the score.")
@click.argument("file", metavar="FILE")
@click.option(
    "--dofs", type=click.Choice(["body", "detailed", "file"]), default="body", show_default=True,
    help="Whose curves: the body's 22, the detailed body's, or the angle channels of the file.",
)  # fmt: skip
@click.option("--joints", metavar="A,B,...", help="Only these joints, of the body or of the file.")
@click.option(
    "--tolerance", "tolerance_deg", type=click.FloatRange(0, min_open=True), default=1.0, show_default=True,
    metavar="DEG", help="Degrees: greater makes fewer pieces, smaller a closer fit.",
)  # fmt: skip
@click.option("--out", metavar="PAGE.html", type=click.Path(dir_okay=False), help="Draw the score on a page.")
@click.option("--json", "as_json", is_flag=True, help="Print the whole score as JSON: degrees and seconds.")
@reading_options
def decompose(
    file: str,
    dofs: str,
    joints: str | None,
    tolerance_deg: float,
    out: str | None,
    as_json: bool,
    positions: str,
    asf: str | None,
    amc_fps: float | None,
    animation: str | None,
    strict: bool,
) -> int:
    """Take a recorded motion apart into actionlets: single movements of single degrees of freedom.

    Prints a line for each degree of freedom: the RMS error of the score in degrees, the range of the angle,
    how many pieces it takes, and how many times smaller they are than the samples.

    \b
    Examples:
      gmr decompose walk.bvh
      gmr decompose walk.bvh --out score.html        the score, drawn like music
      gmr decompose 07_01.amc --dofs file --joints lfemur,ltibia
      gmr decompose walk.bvh --tolerance 0.5 --json | jq '.dofs["left_knee.flexion"].track'

    Exit codes: 0 done, 1 the file could not be read or taken apart, 2 wrong usage, 130 interrupted.
    """
    from gmr.actionlets.decomposition import decompose as decomposed

    motion, said = read_noting(
        file, positions=positions, asf=asf, fps=amc_fps, animation=animation, strict=strict
    )
    for warning in said:
        say(warning)
    wanted = None if joints is None else [name.strip() for name in joints.split(",") if name.strip()]
    with naming(motion):
        found = decomposed(motion, _body(dofs), wanted, tolerance_deg)
    if out is not None:
        _write(found, out, Path(file).name)
    if as_json:
        click.echo(json.dumps({"file": file, "page": out, **found.as_dict()}, indent=2, allow_nan=False))
    else:
        click.echo(_printed(found, file))
        if out is not None:
            click.echo(f"drawn: {out}")
    return 0


def _body(dofs: str) -> Body | None:
    from gmr.actionlets import Body

    return None if dofs == "file" else Body.of(detailed=dofs == "detailed")


def _write(found: Decomposed, out: str, name: str) -> None:
    from gmr.actionlets.decomposition.page import page
    from gmr.replacing import replacing

    with replacing(out) as (file,):
        file.write(page(found, name).encode("utf-8"))


def _printed(found: Decomposed, file: str) -> str:
    table = found.table()
    width = max(len(dof) for dof in table["dof"])
    lines = [
        f"{file}: {found.score.duration:.2f} s, {len(table)} degrees of freedom, {found.score.piece_count}"
        f" pieces; RMS {found.median_rms_deg:.2f} degrees (median), {found.p90_rms_deg:.2f} (90 %);"
        f" {found.ratio:.1f} times smaller than its samples",
        " ".join([f"  {'':<{width}}  {'RMS':>6}", *(f"{head:>{wide}}" for head, wide in _HEADS)]),
    ]
    still = 0
    for row, moves in zip(table.rows(), found.moving.tolist(), strict=True):
        if not moves:
            still += 1
            continue
        lines.append(
            f"  {row['dof']:<{width}}  {row['rms_deg']:>6.2f} {row['max_deg']:>6.2f} {row['low_deg']:>7.1f}"
            f" {row['high_deg']:>7.1f} {row['pieces']:>6} {row['silences']:>5} {row['ratio']:>6.1f}"
        )
    if still:
        lines.append(f"  {still} more hold one angle throughout")
    return "\n".join(lines)
