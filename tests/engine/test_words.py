"""Text from outside is made harmless whatever it is; numbers agree with their nouns."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.words import counted, plain, plural, shortened, terminal

ANY_TEXT = st.text(st.characters(min_codepoint=0, max_codepoint=0x10FFFF))  # lone surrogates and control codes too
BAD = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2028\u2029\u2066-\u2069\ud800-\udfff]")
ROOT = Path(__file__).parents[2]


@given(ANY_TEXT)
def test_nothing_that_steers_a_screen_or_a_terminal_is_left(text: str) -> None:
    assert not BAD.search(plain(text)) and "\n" not in plain(text)
    assert not BAD.search(plain(text, lines=True))
    assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]", terminal(text))
    plain(text).encode(), terminal(text).encode()


@given(ANY_TEXT, st.integers(3, 80))
def test_no_text_is_longer_than_asked(text: str, longest: int) -> None:
    assert len(plain(text, longest=longest)) <= longest
    assert len(shortened(text, longest)) <= longest


@pytest.mark.parametrize("text", ["<img src=/dev/zero>", "<b>Ärger</b> & 顔.csv", "שלום.csv", "final [1]"])
def test_ordinary_text_and_markup_stay_as_they_are(text: str) -> None:
    assert plain(text) == terminal(text) == text


def test_names_keep_both_ends_and_terminals_tell_what_was_there() -> None:
    assert plain("a" * 50 + ".retake", longest=20) == "a" * 13 + "…retake"
    assert terminal("\x1b[2Jsafe\u202egpj") == "\\x1b[2Jsafe\\u202egpj"
    assert plain("e" + "\u0301" * 50) == "e" + "\u0301" * 4


@pytest.mark.parametrize(("number", "said"), [(0, "0 frames"), (1, "1 frame"), (2, "2 frames"), (1250, "1,250 frames")])
def test_numbers_agree_with_their_nouns(number: int, said: str) -> None:
    assert counted(number, "frame") == said


def test_irregular_nouns_and_verbs() -> None:
    assert counted(1, "vertex", "vertices") == "1 vertex" and counted(3, "vertex", "vertices") == "3 vertices"
    assert plural(1, "is", "are") == "is"
