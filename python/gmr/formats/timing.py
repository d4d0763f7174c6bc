"""What stands before the rows of a text file's frames: ``MOTION``, their count, and the time of one."""

from __future__ import annotations

import re
from typing import Final, NamedTuple

from gmr.formats.numerals import number, why_no_number
from gmr.formats.text import Text, shown

__all__ = ["Timing", "read_timing"]

_FRAMES = re.compile(rb"\s*+Frames\s*+:?[^\S\r\n]*+(\S*)", re.IGNORECASE)
_FRAME_TIME = re.compile(rb"\s*+Frame\s*+Time\s*+:?[^\S\r\n]*+(\S*)", re.IGNORECASE)
_MOST_FRAMES: Final = 10**18
"""A count of as many digits or more is taken for this; no file holds as many."""


class Timing(NamedTuple):
    """How many frames there are, and how long each is.

    Args:
        frames: as many as are declared.
        frame_time: seconds.
        at: the byte after the count, in the line to blame where it is wrong.
    """

    frames: int
    frame_time: float
    at: int

    @property
    def said(self) -> str:
        """The count in words, as the subject of a sentence that goes on with what they are."""
        least = "at least " if self.frames == _MOST_FRAMES else ""
        return f"{least}{self.frames:,} frame{' is' if self.frames == 1 else 's are'}"


def read_timing(text: Text) -> Timing:
    """Reads from MOTION to the frame time."""
    word = text.take()
    if not word:
        text.odd("the file has no MOTION; read as a skeleton without frames. Export it again for its frames.")
        return Timing(0, 0.0, text.at)
    if word.upper() != b"MOTION":
        what = f"{shown(word)} follows the last joint. Write MOTION there, or ROOT for another tree."
        if word == b"}":
            what = "there is one '}' too many. Remove it, or write the '{' that is missing."
        raise text.failure(what, at=text.at - len(word), expected="MOTION", column=True)
    frames, at = _frame_count(text), text.at
    frame_time = _frame_time(text)
    if frame_time == 0 and frames > 1:
        text.odd(
            "the frame time is 0, so that the frames have no duration. Write seconds after 'Frame Time:'."
        )
    return Timing(frames, frame_time, at)


def _frame_count(text: Text) -> int:
    match = text.take_match(_FRAMES)
    if match is None:
        what = f"MOTION is followed by {_next(text)}. Write 'Frames:' and the number of frames."
        raise text.failure(what, expected="Frames: <count>")
    found = match[1]
    if not found.isdigit():
        what = shown(found) if found else "nothing"
        what = f"'Frames:' is followed by {what}. Write how many frames there are, a whole number."
        raise text.failure(what, expected="a whole number")
    # Python refuses to convert thousands of digits.
    digits = found.lstrip(b"0")
    return int(digits or b"0") if len(digits) <= 18 else _MOST_FRAMES


def _frame_time(text: Text) -> float:
    match = text.take_match(_FRAME_TIME)
    if match is None or not match[1]:
        what = (
            f"the frame count is followed by {_next(text)}. Write 'Frame Time:' and the seconds of a frame."
        )
        raise text.failure(what, expected="Frame Time: <seconds>")
    found = match[1]
    value = number(found)
    if value is None or value < 0:
        why = (
            why_no_number(found) if value is None else f"{shown(found)} is negative. Write 0 seconds or more."
        )
        raise text.failure(f"Frame Time: {why}", at=text.at - len(found), expected="seconds", column=True)
    return value


def _next(text: Text) -> str:
    return shown(text.peek()) if text.peek() else "the end of the file"
