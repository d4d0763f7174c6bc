"""What is written as GMR text reads back as it was."""

from __future__ import annotations

from hypothesis import given

from gmr.formats.gmr import read_gmr_text, write_gmr
from gmr.motion import Motion
from test_forest import walks


@given(walks())
def test_any_motion_comes_back(walk: tuple[Motion, Motion]) -> None:
    for motion in walk:
        again = read_gmr_text(write_gmr(motion))
        assert again == motion
        assert again.layout == motion.layout
