from __future__ import annotations

import numpy as np
import pytest

from engine.errors import EditError
from engine.speech.transcript import TUNING, Said, Transcript, confidence, doubt
from engine.speech.visemes import Cue


def transcript(*sure: float, heard: bool = False) -> Transcript:
    said = tuple(Said(f"w{at}", at, at + 1, each, (Cue(at, at + 1, "AA"),)) for at, each in enumerate(sure))
    return Transcript(said, tuple(each.phones[0] for each in said), len(sure), heard=heard)


def test_a_word_is_the_surer_the_nearer_its_score_is_to_the_best() -> None:
    sure = confidence([-1e9, -100, TUNING.middle, -20, -10, -5, 0])
    assert (np.diff(sure) >= 0).all() and sure[2] == 0.5 and sure[0] < 0.01 and sure[-1] > 0.99
    assert len(confidence([])) == 0


def test_where_all_scores_are_low_a_word_is_measured_by_the_others_but_a_text_that_is_all_wrong_is_doubted() -> None:
    assert (confidence([-38, -40, -42, -55, -90])[:4] > 0.5).all() and confidence([-38, -40, -42, -55, -90])[4] < 0.1
    assert (confidence([-80, -85, -90]) < 0.5).all()


@pytest.mark.parametrize(
    ("sure", "heard", "sentence"),
    [
        ((0.9, 0.8, 0.9), False, ""),
        ((0.9, 0.1, 0.9), False, "1 word of the text does not fit the sound: 'w1' at 1.00 s."),
        ((0.1, 0.1, 0.9), False, "The text is hardly what is said: 2 of 3 words do not fit the sound."),
        ((0.1, 0.1, 0.9), True, "The words that were heard fit the sound badly: it may be noisy, or in another language."),
        ((0.9,) * 9 + (0.1,) * 5, False, "5 words of the text do not fit the sound: 'w9' at 9.00 s, 'w10' at 10.00 s, "
         "'w11' at 11.00 s, 'w12' at 12.00 s…"),
    ],
)  # fmt: skip
def test_doubt_is_one_sentence(sure: tuple[float, ...], heard: bool, sentence: str) -> None:
    assert doubt(transcript(*sure, heard=heard)) == sentence


def test_a_lane_holds_the_phones_and_nothing_has_none() -> None:
    assert transcript(0.9, 0.9).lane("a").originals == transcript(0.9, 0.9).phones
    with pytest.raises(EditError, match="no cue"):
        transcript().lane("a")
