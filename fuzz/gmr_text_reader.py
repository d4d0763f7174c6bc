"""The reader of GMR text under a coverage-guided fuzzer: blocks, trees, channels, rows, what is written back.

A file is refused with ``FormatError`` or read; what is read is written in both forms and read again as it
was. Anything else that is raised, a hang or a gigabyte taken is a finding. See README.md for the command.
"""

from __future__ import annotations

from fuzzing import checked, fuzz, instrumented

with instrumented():
    from gmr.formats.gmr import read_gmr, write_gmr, write_gmrb
    from gmr.formats.gmr_text_reader import read_gmr_text


def check(data: bytes) -> None:
    """One file."""
    motion, _ = checked(lambda strict: read_gmr_text(data, name="fuzzed.gmr", strict=strict), "fuzzed.gmr")
    if motion is None:
        return
    text, binary = read_gmr(write_gmr(motion)), read_gmr(write_gmrb(motion))
    assert text == binary == motion
    assert text.layout == binary.layout == motion.layout
    for one, other in zip(text.source.numbers, motion.source.numbers, strict=True):
        assert one.tobytes() == other.tobytes()


if __name__ == "__main__":
    fuzz(check)
