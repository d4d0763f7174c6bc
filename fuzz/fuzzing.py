"""What the targets of readers share: how a file may be refused, and how a run begins.

Import it before gmr and put gmr's own imports under :func:`instrumented`.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import TypeVar

import atheris

__all__ = ["checked", "fuzz", "instrumented", "refused_in_a_sentence"]

LONGEST_MESSAGE = 1000

Read = TypeVar("Read")


def instrumented() -> AbstractContextManager[None]:
    """Within it, what is imported of gmr is watched by the fuzzer."""
    watched = ["gmr.formats", "gmr.channels", "gmr.skeleton", "gmr.motion", "gmr.acclaim", "gmr.dof_rows"]
    entered: AbstractContextManager[None] = atheris.instrument_imports(include=watched)
    return entered


def refused_in_a_sentence(read: Callable[[], Read], *names: str) -> Read | None:
    """What ``read`` gives; None where it refuses, in a sentence that begins with one of the file's names."""
    from gmr.errors import FormatError

    try:
        return read()
    except FormatError as error:
        if len(str(error)) > LONGEST_MESSAGE or not str(error).startswith(names):
            raise AssertionError(f"no sentence that helps: {error}") from error
        return None


def checked(read: Callable[[bool], Read], *names: str) -> tuple[Read | None, Read | None]:
    """What ``read`` gives as usual and strictly, None where it refuses; strict reads nothing more."""
    usual = refused_in_a_sentence(lambda: read(False), *names)
    strictly = refused_in_a_sentence(lambda: read(True), *names)
    assert usual is not None or strictly is None, "strict reads what is refused otherwise"
    return usual, strictly


def fuzz(check: Callable[[bytes], None]) -> None:
    """Runs a target until it finds something; the command line is libFuzzer's."""
    warnings.simplefilter("ignore")
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()
