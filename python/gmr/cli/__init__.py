"""The command line: nothing is imported here before an interrupt can be answered."""

from __future__ import annotations

__all__ = ["main"]


def main(args: list[str] | None = None) -> None:
    """Run the command line and leave the process with its exit code."""
    try:
        from gmr.cli.commands import gmr
        from gmr.cli.common import finished

        code = finished(gmr, args)
    except KeyboardInterrupt:
        # Before or after the command itself, which answers an interrupt in the same words.
        import sys

        sys.stderr.write("gmr: interrupted; no file was left half-written\n")
        code = 130
    raise SystemExit(code)
