"""BVH text for tests: a small file whose parts can be exchanged, and random spellings of a motion."""

from __future__ import annotations

import warnings

from hypothesis import strategies as st

from gmr import Motion
from gmr.formats.bvh import read_bvh, write_bvh

WALK = """HIERARCHY
ROOT Hips
{
\tOFFSET 0 0 0
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\tJOINT LeftLeg
\t{
\t\tOFFSET 1 -2 3.5
\t\tCHANNELS 3 Zrotation Xrotation Yrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0 -1 0
\t\t}
\t}
}
MOTION
Frames: 2
Frame Time: 0.0083333
1 2 3 4 5 6 7 8 9
-1.5 -2.25 -3 -4 -5 -6 -7 -8 -9.125
"""


def walk(*changes: tuple[str, str]) -> bytes:
    """The small file with parts exchanged, each once."""
    text = WALK
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text.encode()


def read_quietly(data: bytes) -> Motion:
    """The motion, whatever is odd about it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return read_bvh(data)


@st.composite
def spellings(draw: st.DrawFn, motion: Motion) -> bytes:
    """The file of a motion in another program's manner: blanks, line ends, case of keywords, braces."""
    lines = write_bvh(motion).decode().splitlines()
    rows_from = next(k for k, line in enumerate(lines) if line.startswith("Frame Time:")) + 1
    gap = draw(st.sampled_from([" ", "\t", "   ", " \t"]))
    newline = draw(st.sampled_from(["\n", "\r\n", "\r", "\n\n"]))
    tail = draw(st.sampled_from(["", " ", "\t "]))
    indent = draw(st.sampled_from(["", "  ", "\t"]))
    manner = draw(st.sampled_from(["upper", "lower", "title", "strip"]))
    brace_in_line = draw(st.booleans())

    def case(word: str) -> str:
        return str(getattr(word, manner)())

    def spelled(line: str) -> str:
        word, *rest = line.split()
        if word in ("ROOT", "JOINT", "End", "Frames:", "Frame", "HIERARCHY", "MOTION", "OFFSET", "CHANNELS"):
            word = case(word)
        if line.strip() == "End Site":
            rest = [case("Site")]
        return indent + gap.join([word, *rest]) + tail

    head = newline.join(spelled(line) for line in lines[:rows_from])
    if brace_in_line:
        head = head.replace(f"{tail}{newline}{indent}{{", f"{tail} {{")
    rows = [indent + gap.join(line.split()) + tail for line in lines[rows_from:]]
    return newline.join([head, *rows]).encode() + draw(st.sampled_from([b"", b"\n", b"\r\n \r\n", b"\n\0\0"]))
