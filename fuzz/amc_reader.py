"""The whole ASF/AMC reader under a coverage-guided fuzzer: both files, and what is written back.

An input is an ASF, a line of ``=``, and an AMC. It is refused with ``FormatError`` or read; what is read is
written and read again bit-identical. Anything else that is raised, a hang or a gigabyte taken is a finding.
See README.md for the command.
"""

from __future__ import annotations

from fuzzing import checked, fuzz, instrumented

with instrumented():
    from gmr.dof_rows import DofRows
    from gmr.formats.asf_amc import amc_chunks, asf_chunks, read_amc

BETWEEN = b"\n=====\n"


def check(data: bytes) -> None:
    """One pair of files."""
    skeleton, _, frames = data.partition(BETWEEN)
    motion, _ = checked(
        lambda strict: read_amc(frames, name="fuzzed.amc", asf=skeleton, strict=strict),
        "fuzzed.amc",
        "<text>",
    )
    if motion is None:
        return
    again = read_amc(b"".join(amc_chunks(motion)), asf=b"".join(asf_chunks(motion)))
    before, after = motion.source, again.source
    assert isinstance(before, DofRows)
    assert isinstance(after, DofRows)
    assert again.skeleton == motion.skeleton
    assert after.acclaim == before.acclaim
    assert after.values.tobytes() == before.values.tobytes()
    assert len(motion.positions()) == motion.frame_count


if __name__ == "__main__":
    fuzz(check)
