"""The whole ASF/AMC reader under a coverage-guided fuzzer: both files, and what is written back.

An input is an ASF, a line of ``=``, and an AMC. It is refused with ``FormatError`` or read; what is read is
written and read again bit-identical. Anything else that is raised, a hang or a gigabyte taken is a finding.
See README.md for the command.
"""

from __future__ import annotations

import sys
import warnings

import atheris

with atheris.instrument_imports(include=["gmr.formats", "gmr.acclaim", "gmr.dof_rows", "gmr.motion"]):
    from gmr.dof_rows import DofRows
    from gmr.errors import FormatError
    from gmr.formats.asf_amc import amc_chunks, asf_chunks, read_amc
    from gmr.motion import Motion

LONGEST_MESSAGE = 1000
BETWEEN = b"\n=====\n"


def attempt(skeleton: bytes, frames: bytes, *, strict: bool) -> Motion | None:
    """The motion, None where it is refused in a sentence."""
    try:
        return read_amc(frames, name="fuzzed.amc", asf=skeleton, strict=strict)
    except FormatError as error:
        if len(str(error)) > LONGEST_MESSAGE or not str(error).startswith(("fuzzed.amc", "<text>")):
            raise AssertionError(f"no sentence that helps: {error}") from error
        return None


def check(data: bytes) -> None:
    """One pair of files."""
    skeleton, _, frames = data.partition(BETWEEN)
    motion = attempt(skeleton, frames, strict=False)
    strictly = attempt(skeleton, frames, strict=True)
    if motion is None:
        assert strictly is None, "strict reads what is refused otherwise"
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
    warnings.simplefilter("ignore")
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()
