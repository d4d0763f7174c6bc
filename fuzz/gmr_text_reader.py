"""The reader of GMR text under a coverage-guided fuzzer: blocks, trees, channels, rows, what is written back.

A file is refused with ``FormatError`` or read; what is read is written in both forms and read again as it
was. Anything else that is raised, a hang or a gigabyte taken is a finding. See README.md for the command.
"""

from __future__ import annotations

import sys
import warnings

import atheris

with atheris.instrument_imports(include=["gmr.formats", "gmr.channels", "gmr.skeleton", "gmr.motion"]):
    from gmr.errors import FormatError
    from gmr.formats.gmr import read_gmr, write_gmr, write_gmrb
    from gmr.formats.gmr_text_reader import read_gmr_text
    from gmr.motion import Motion

LONGEST_MESSAGE = 1000


def attempt(data: bytes, *, strict: bool) -> Motion | None:
    """The motion, None where it is refused in a sentence."""
    try:
        return read_gmr_text(data, name="fuzzed.gmr", strict=strict)
    except FormatError as error:
        if len(str(error)) > LONGEST_MESSAGE or not str(error).startswith("fuzzed.gmr"):
            raise AssertionError(f"no sentence that helps: {error}") from error
        return None


def check(data: bytes) -> None:
    """One file."""
    motion = attempt(data, strict=False)
    strictly = attempt(data, strict=True)
    if motion is None:
        assert strictly is None, "strict reads what is refused otherwise"
        return
    text, binary = read_gmr(write_gmr(motion)), read_gmr(write_gmrb(motion))
    assert text == binary == motion
    assert text.layout == binary.layout == motion.layout
    for one, other in zip(text.source.numbers, motion.source.numbers, strict=True):
        assert one.tobytes() == other.tobytes()


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()
