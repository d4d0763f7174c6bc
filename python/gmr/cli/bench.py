"""``gmr bench``: gmr against its peers, on this machine."""

from __future__ import annotations

import dataclasses
import json
import platform

import click

EXAMPLES = """
\b
Examples:
  gmr bench                      the whole table
  gmr bench fk bvh-load          two claims of it
  gmr bench --json > here.json   for a machine

Exit codes: 0 done, 1 an input could not be made, 2 wrong usage, 130 interrupted.
"""


@click.command(short_help="Measure gmr against its peers on this machine.", epilog=EXAMPLES)
@click.argument("claims", nargs=-1)
@click.option("--smoke", is_flag=True, help="Small inputs, one round: shows that all runs, measures nothing.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of the table.")
@click.option("--list", "list_claims", is_flag=True, help="Name the claims and stop.")
def bench(claims: tuple[str, ...], smoke: bool, as_json: bool, list_claims: bool) -> None:
    """Measure gmr against its peers on this machine, in one run, as ratios with their spread.

    Installs nothing: peers that are missing are named with what installs them
    (all at once: pip install 'gmr-motion[bench]').
    """
    from gmr.bench import CLAIMS, run

    if list_claims:
        for name, claim in CLAIMS.items():
            click.echo(f"{name:12} {(claim.__doc__ or '').splitlines()[0]}")
        return
    if unknown := [name for name in claims if name not in CLAIMS]:
        raise click.UsageError(f"no such claim: {', '.join(unknown)}. There are: {', '.join(CLAIMS)}.")

    rows = []
    if not as_json:
        click.echo(_HEADER)
    for row in run(claims, smoke=smoke):
        rows.append(row)
        if not as_json:
            click.echo(_line(row))
    if as_json:
        report = {"machine": _machine(), "smoke": smoke, "rows": [dataclasses.asdict(row) for row in rows]}
        click.echo(json.dumps(report, indent=2))
    elif smoke:
        click.echo("A smoke run: these figures measure nothing.", err=True)


_HEADER = f"{'work':46} {'gmr':>22}   {'peer':24} {'ratio (lowest to highest)':>28} {'to reach':>9}"


def _line(row) -> str:  # type: ignore[no-untyped-def]
    ours = f"{row.ours:,.3g} {row.unit}" if row.ours < 1000 else f"{row.ours:,.0f} {row.unit}"
    ratio = (
        row.note if row.ratio is None else f"{row.ratio:.1f}x ({row.ratio_low:.1f} to {row.ratio_high:.1f})"
    )
    theirs = "" if row.theirs is None else f"{row.peer} {row.theirs:.3g}"
    target = "" if row.target is None else f"{row.target:g}x"
    return f"{row.work:46} {ours:>22}   {theirs or row.peer:24} {ratio:>28} {target:>9}".rstrip()


def _machine() -> dict[str, str]:
    from gmr import _core

    return {
        "processor": platform.processor() or platform.machine(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "instruction_set": _core.instruction_set(),
    }
