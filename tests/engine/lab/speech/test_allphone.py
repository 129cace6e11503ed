from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import EngineError
from engine.lab.speech import allphone


def test_without_pocketsphinx_there_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(allphone, "available", lambda: False)
    with pytest.raises(EngineError, match="Hearing phones needs PocketSphinx"):
        allphone.listen(tmp_path / "speech.wav")


def test_silence_is_heard_as_silence_of_the_right_length() -> None:
    pytest.importorskip("pocketsphinx")
    hiss = 1e-3 * np.random.default_rng(0).standard_normal(2 * allphone.RATE)
    cues = allphone.heard(hiss)
    assert cues[0].start_s == 0.0 and cues[-1].stop_s == pytest.approx(2.0, abs=0.1)
    assert sum(cue.stop_s - cue.start_s for cue in cues if cue.label == "SIL") > 1.5


@pytest.mark.parametrize("seconds", [0.0, 1 / 16_000, 0.008, 0.03])
def test_what_is_too_short_to_be_heard_has_no_phones(seconds: float) -> None:
    assert allphone.heard(np.ones(round(seconds * allphone.RATE))) == []


def test_digital_silence_is_heard_as_silence() -> None:
    pytest.importorskip("pocketsphinx")
    assert {cue.label for cue in allphone.heard(np.zeros(allphone.RATE))} == {"SIL"}
