"""The reader of GMR binary files under a coverage-guided fuzzer: container, arrays, skeleton, frames.

Each input is tried as it is, and once more with the length that its JSON header has, which a mutation seldom
gets right. A file is refused with ``FormatError`` or read; what is read is written and read again as it was,
unless a number is not finite, which only ``strict`` looks for. See README.md for the command.
"""

from __future__ import annotations

import json
import sys
import warnings

import atheris

with atheris.instrument_imports(include=["gmr.formats", "gmr.channels", "gmr.skeleton", "gmr.motion"]):
    from gmr.errors import FormatError
    from gmr.formats.gmr import read_gmr, write_gmr, write_gmrb
    from gmr.formats.gmr_binary_reader import read_gmr_binary
    from gmr.motion import Motion

LONGEST_MESSAGE = 1000


def attempt(data: bytes, *, strict: bool) -> Motion | None:
    """The motion, None where it is refused in a sentence."""
    try:
        return read_gmr_binary(data, name="fuzzed.gmrb", strict=strict)
    except FormatError as error:
        if len(str(error)) > LONGEST_MESSAGE:
            raise AssertionError(f"no sentence that helps: {error}") from error
        return None


def repaired(data: bytes) -> bytes | None:
    """The file with the length that its header has; None where that is no JSON."""
    try:
        _, end = json.JSONDecoder().raw_decode(data[8:].decode("latin-1"))
    except (ValueError, RecursionError):
        return None
    end += -end % 8
    return end.to_bytes(8, "little") + data[8:]


def check(data: bytes) -> None:
    """One file."""
    for form in (data, repaired(data)):
        if form is not None:
            check_one(form)


def check_one(data: bytes) -> None:
    """One form of it."""
    motion = attempt(data, strict=False)
    strictly = attempt(data, strict=True)
    if motion is None:
        assert strictly is None, "strict reads what is refused otherwise"
        return
    if strictly is None:
        return
    text, binary = read_gmr(write_gmr(motion)), read_gmr(write_gmrb(motion))
    assert text == binary
    assert binary.frame_count == motion.frame_count
    assert binary.positions(dtype=float).tobytes() == motion.positions(dtype=float).tobytes()


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()
