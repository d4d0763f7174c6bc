"""Sentences in a terminal: no line too wide, and what is copied from one works."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gmr.cli.paragraphs import listed_sentences, paragraph

word = st.text("abcde-.", min_size=1, max_size=12).filter(lambda word: not word.startswith("--"))
words = st.lists(word, min_size=1, max_size=40)


@given(words, st.integers(20, 200))
def test_no_word_is_lost_and_no_line_too_wide(words: list[str], columns: int) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COLUMNS", str(columns))
        lines = paragraph(" ".join(words), first="- ", then="  ")
    assert " ".join(line[2:] for line in lines).split() == words
    assert all(len(line) <= min(columns, 100) for line in lines)
    assert [line[:2] for line in lines] == ["- ", *["  "] * (len(lines) - 1)]


def test_an_option_stays_on_one_line_with_plain_spaces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "50")
    options = ['--weight "hips velocity=2.5"', '--weight "trajectory facing=0.25"', "--prune 30%"]
    lines = listed_sentences([f"To evaluate with these weights: {' '.join(options)}", "Second."])
    assert lines == [
        "- To evaluate with these weights:",
        '  --weight "hips velocity=2.5"',
        '  --weight "trajectory facing=0.25" --prune 30%',
        "- Second.",
    ]
