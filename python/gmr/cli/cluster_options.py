"""Options of the commands whose work can be done elsewhere: ``workers`` and ``cluster``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

__all__ = ["check_workers", "cluster_options"]

Command = TypeVar("Command", bound=Callable[..., Any])


def cluster_options(command: Command) -> Command:
    """``workers`` and ``cluster`` as :func:`gmr.cluster.results` has them."""
    options = (
        click.option(
            "--workers", type=click.IntRange(min=1),
            help="Run trials on so many processes.  [default: threads of this one]",
        ),
        click.option(
            "--cluster", metavar="ADDRESS|local",
            help="Run trials on a Dask cluster: its scheduler, or one of its own on this machine.",
        ),
    )  # fmt: skip
    for option in reversed(options):
        command = option(command)
    return command


def check_workers(workers: int | None, cluster: str | None) -> None:
    """Refuses, as wrong usage, workers that are counted for a cluster that has its own."""
    from gmr.cluster import LOCAL

    if workers and cluster not in (None, LOCAL):
        raise click.UsageError(f"the cluster at {cluster} has workers of its own; leave --workers out")
