from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from engine.errors import EngineError
from engine.speech import pronounce
from engine.speech.durations import durations_s, laid_out, rate_of

KNOWN = {
    "our": (("AW", "ER"),),
    "little": (("L", "IH", "T", "AH", "L"),),
    "brother": (("B", "R", "AH", "DH", "ER"),),
    "woke": (("W", "OW", "K"),),
}
LINE = "Our little brother, woke"


@pytest.fixture(autouse=True)
def known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pronounce, "dictionary", lambda: KNOWN)
    monkeypatch.setattr(pronounce.espeak, "installed", lambda: False)


def test_a_line_is_laid_out_word_by_word_with_its_pauses() -> None:
    found = laid_out(LINE)
    assert [each.word for each in found.said] == ["Our", "little", "brother", "woke"]
    assert all(before.stop_s == after.start_s for before, after in pairwise(found.phones))
    assert [cue.label for cue in found.phones].count("SIL") == 1
    assert found.phones[-1].stop_s == found.duration_s == found.said[-1].stop_s
    assert found.lane("a line").cues == found.phones


@pytest.mark.parametrize("rate", [0.5, 1.0, 2.0])
def test_a_rate_is_what_is_measured_of_it(rate: float) -> None:
    assert laid_out(LINE, rate=rate).duration_s == pytest.approx(laid_out(LINE).duration_s / rate)
    assert rate_of(laid_out(LINE, rate=rate)) / rate_of(laid_out(LINE)) == pytest.approx(rate)


def test_vowels_are_longer_at_the_end_of_a_phrase_and_before_what_is_voiced() -> None:
    assert durations_s(["B", "IY"], is_last=True)[1] > durations_s(["B", "IY"], is_last=False)[1]
    assert durations_s(["B", "IY", "D"], is_last=True)[1] > durations_s(["B", "IY", "T"], is_last=True)[1]
    assert (durations_s(["S", "T", "R", "EH", "NG", "K", "TH", "S"], is_last=False) > 0.03).all()
    assert np.isfinite(durations_s(["??"], is_last=True)).all()


def test_what_nothing_pronounces_is_named_with_what_would_help() -> None:
    with pytest.raises(EngineError, match=r"does not have 'kubernetes'.*eSpeak"):
        laid_out("our Kubernetes")
    with pytest.raises(EngineError, match=r"'de' need eSpeak NG.*TextGrid"):
        laid_out("unser", language="de")
    with pytest.raises(EngineError, match=r"0\.3 to 3"):
        laid_out(LINE, rate=9)


def test_without_dictionary_and_espeak_a_sentence_says_what_still_works(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pronounce, "dictionary", dict)
    with pytest.raises(EngineError, match=r"neither is installed.*mouth cues still work"):
        laid_out(LINE)
