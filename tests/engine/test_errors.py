from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from engine.errors import LONGEST, EngineError, FormatError


@given(st.text(max_size=2000), st.text(max_size=2000))
def test_what_a_person_reads_is_one_line_that_is_not_too_long(sentence: str, advice: str) -> None:
    error = FormatError(sentence, advice)
    for text in (str(error), error.sentence, error.advice):
        assert len(text) <= LONGEST and text.isprintable()


def test_ordinary_sentences_stay_as_they_are() -> None:
    error = EngineError("Ärger in „take.csv“: 5 % of 3 × 4.", "Use another – or none.")
    assert str(error) == "Ärger in „take.csv“: 5 % of 3 × 4. Use another – or none."


def test_a_long_name_keeps_its_beginning_and_its_end() -> None:
    sentence = EngineError(f"{'x' * 5000}.csv is damaged.").sentence
    assert sentence.startswith("xxx") and sentence.endswith(".csv is damaged.") and "…" in sentence


def test_control_characters_and_directions_of_writing_do_not_reach_a_terminal() -> None:
    error = EngineError("a\x1b[31m\nb\u202ec\x00d\tis gone.")
    assert error.sentence == "a [31m b c d is gone."
