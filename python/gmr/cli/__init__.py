"""The command line: nothing is imported here before an interrupt can be answered."""

import sys

TYPE_CHECKING = False

if TYPE_CHECKING:
    from types import TracebackType

__all__ = ["main"]

_INTERRUPTED = "gmr: interrupted; no file was left half-written\n"


def main(args: list[str] | None = None) -> None:
    """Run the command line and leave the process with its exit code."""
    try:
        from gmr.cli.commands import gmr
        from gmr.cli.common import finished

        code = finished(gmr, args)
    except KeyboardInterrupt:
        # Before or after the command itself, which answers an interrupt in the same words.
        sys.stderr.write(_INTERRUPTED)
        code = 130
    raise SystemExit(code)


def _answer_interrupts() -> None:
    """Outside of main as well, in the launcher that installers write, an interrupt is one sentence."""
    otherwise = sys.excepthook

    def answer(kind: type[BaseException], error: BaseException, traceback: "TracebackType | None") -> None:
        if issubclass(kind, KeyboardInterrupt):
            sys.stderr.write(_INTERRUPTED)
        else:
            otherwise(kind, error, traceback)

    sys.excepthook = answer


_answer_interrupts()
