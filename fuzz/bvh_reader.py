"""The whole BVH reader under a coverage-guided fuzzer: grammar, timing, rows, and what is written back.

A file is refused with ``FormatError`` or read; what is read is written and read again bit-identical.
Anything else that is raised, a hang or a gigabyte taken is a finding. See README.md for the command.
"""

from __future__ import annotations

from fuzzing import checked, fuzz, instrumented

with instrumented():
    from gmr.formats.bvh import read_bvh, write_bvh


def check(data: bytes) -> None:
    """One file."""
    motion, _ = checked(lambda strict: read_bvh(data, name="fuzzed.bvh", strict=strict), "fuzzed.bvh")
    if motion is None:
        return
    again = read_bvh(write_bvh(motion))
    assert again.skeleton == motion.skeleton
    assert again.layout == motion.layout
    assert again.frame_time == motion.frame_time
    assert again.rows.tobytes() == motion.rows.tobytes()


if __name__ == "__main__":
    fuzz(check)
