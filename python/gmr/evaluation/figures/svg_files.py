"""Figures as SVG files: all of them, or none."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from gmr.errors import MissingExtraError
from gmr.pages.figure import Figure
from gmr.replacing import replacing

__all__ = ["check_svg", "write_svg"]


def check_svg() -> None:
    """See to it that figures can be written.

    Raises:
        MissingExtraError: vl-convert-python is not installed.
    """
    try:
        import vl_convert  # noqa: F401
    except ImportError as error:
        raise MissingExtraError("vl-convert-python", "report", "Writing figures as SVG") from error


def write_svg(figures: Mapping[Path, Figure]) -> tuple[Path, ...]:
    """Write figures by their file; their folders are made where they are missing.

    Raises:
        MissingExtraError: vl-convert-python is not installed.
        OSError: a folder may not be written to, or the disk is full.
    """
    check_svg()
    import vl_convert

    drawn = {path: vl_convert.vegalite_to_svg(figure.description()) for path, figure in figures.items()}
    for path in drawn:
        path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(*drawn) as files:
        for file, text in zip(files, drawn.values(), strict=True):
            file.write(text.encode())
    return tuple(drawn)
