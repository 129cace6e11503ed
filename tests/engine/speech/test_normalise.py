from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.errors import EditError
from engine.speech.normalise import MOST_WORDS, words_of


@pytest.mark.parametrize(
    ("text", "spoken"),
    [
        ("In 1984", "in nineteen eighty four"),
        ("$3.50", "three dollars and fifty cents"),
        ("$1", "one dollar"),
        ("£1.01", "one pound and one penny"),
        ("$2.5 million", "two point five million dollars"),
        ("5 mm", "five millimeters"),
        ("1 km/h", "one kilometer per hour"),
        ("5 in the box", "five in the box"),
        ("-12°C", "minus twelve degrees celsius"),
        ("0.5%", "zero point five percent"),
        ("1,234 men", "one thousand two hundred and thirty four men"),
        ("007", "zero zero seven"),
        ("21st", "twenty first"),
        ("the 1990s", "the nineteen nineties"),
        ("10:05", "ten oh five"),
        ("9:00", "nine o'clock"),
        ("1½ cups", "one and one half cups"),
        ("3/4", "three quarters"),
        ("Dr. Smith", "doctor smith"),
        ("U.S.A.", "u s a"),
        ("don't ‘quote’ the boys' well-known café", "don't quote the boys' well known café"),
        ("rocks & rolls \N{GRINNING FACE} <b>", "rocks and rolls b"),
    ],
)
def test_text_becomes_the_words_that_are_said(text: str, spoken: str) -> None:
    assert " ".join(word.spoken for word in words_of(text)) == spoken


def test_pauses_follow_the_words_before_them() -> None:
    assert [word.pause for word in words_of("Wait, no. Yes")] == ["short", "long", ""]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "no words"),
        ("\N{GRINNING FACE} ... !", "no words"),
        ("a " * (MOST_WORDS + 1), "5,001 words"),
        ("a" * 70_000, "70,000"),
    ],
)
def test_what_cannot_be_said_is_one_sentence(text: str, sentence: str) -> None:
    with pytest.raises(EditError, match=sentence):
        words_of(text)


@given(st.text(max_size=60))
def test_whatever_is_written_becomes_letters_and_apostrophes_or_a_sentence(text: str) -> None:
    try:
        words = words_of(text)
    except EditError:
        return
    assert all(word.spoken and word.spoken.replace("'", "").isalpha() for word in words)
