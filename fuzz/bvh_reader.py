"""The whole BVH reader under a coverage-guided fuzzer: grammar, timing, rows, and what is written back.

A file is refused with ``FormatError`` or read; what is read is written and read again bit-identical.
Anything else that is raised, a hang or a gigabyte taken is a finding. See README.md for the command.
"""

from __future__ import annotations

import sys
import warnings

import atheris

with atheris.instrument_imports(include=["gmr.formats", "gmr.channels", "gmr.skeleton", "gmr.motion"]):
    from gmr.errors import FormatError
    from gmr.formats.bvh import read_bvh, write_bvh
    from gmr.motion import Motion

LONGEST_MESSAGE = 1000


def attempt(data: bytes, *, strict: bool) -> Motion | None:
    """The motion, None where it is refused in a sentence."""
    try:
        return read_bvh(data, name="fuzzed.bvh", strict=strict)
    except FormatError as error:
        if len(str(error)) > LONGEST_MESSAGE or not str(error).startswith("fuzzed.bvh"):
            raise AssertionError(f"no sentence that helps: {error}") from error
        return None


def check(data: bytes) -> None:
    """One file."""
    motion = attempt(data, strict=False)
    strictly = attempt(data, strict=True)
    if motion is None:
        assert strictly is None, "strict reads what is refused otherwise"
        return
    again = read_bvh(write_bvh(motion))
    assert again.skeleton == motion.skeleton
    assert again.layout == motion.layout
    assert again.frame_time == motion.frame_time
    assert again.rows.tobytes() == motion.rows.tobytes()


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()
