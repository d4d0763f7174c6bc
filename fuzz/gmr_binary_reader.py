"""The reader of GMR binary files under a coverage-guided fuzzer: container, arrays, skeleton, frames.

Each input is tried as it is, and once more with the length that its JSON header has, which a mutation seldom
gets right. A file is refused with ``FormatError`` or read; what is read is written and read again as it was,
unless a number is not finite, which only ``strict`` looks for. See README.md for the command.
"""

from __future__ import annotations

import json

from fuzzing import checked, fuzz, instrumented

with instrumented():
    from gmr.formats.gmr import read_gmr, write_gmr, write_gmrb
    from gmr.formats.gmr_binary_reader import read_gmr_binary


def check(data: bytes) -> None:
    """One file."""
    for form in (data, repaired(data)):
        if form is not None:
            check_one(form)


def check_one(data: bytes) -> None:
    """One form of it."""
    motion, strictly = checked(
        lambda strict: read_gmr_binary(data, name="fuzzed.gmrb", strict=strict), "fuzzed.gmrb"
    )
    if motion is None or strictly is None:
        return
    text, binary = read_gmr(write_gmr(motion)), read_gmr(write_gmrb(motion))
    assert text == binary
    assert binary.frame_count == motion.frame_count
    assert binary.positions(dtype=float).tobytes() == motion.positions(dtype=float).tobytes()


def repaired(data: bytes) -> bytes | None:
    """The file with the length that its header has; None where that is no JSON."""
    try:
        _, end = json.JSONDecoder().raw_decode(data[8:].decode("latin-1"))
    except (ValueError, RecursionError):
        return None
    end += -end % 8
    return end.to_bytes(8, "little") + data[8:]


if __name__ == "__main__":
    fuzz(check)
