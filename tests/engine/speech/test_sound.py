from __future__ import annotations

import numpy as np
import pytest

from engine.speech.sound import RATE, dithered, is_silent, speech_samples


def tone(hz: float, rate: int) -> np.ndarray:
    return np.sin(2 * np.pi * hz * np.arange(rate) / rate)


@pytest.mark.parametrize("rate", [8_000, 11_025, 22_050, 44_100, 48_000])
def test_a_tone_stays_at_any_rate(rate: int) -> None:
    found = speech_samples(tone(1_000, rate), rate)
    assert len(found) == RATE
    assert np.abs(found - tone(1_000, RATE))[500:-500].max() < 0.01


def test_what_lies_above_the_band_does_not_fold_into_it() -> None:
    assert np.abs(speech_samples(tone(12_000, 44_100), 44_100))[500:-500].max() < 0.01


def test_channels_are_mixed_and_nothing_stays_nothing() -> None:
    stereo = np.stack([tone(440, RATE), 0 * tone(440, RATE)], axis=1)
    np.testing.assert_allclose(speech_samples(stereo, RATE), tone(440, RATE) / 2)
    assert len(speech_samples(np.zeros(0), 44_100)) == 0


def test_silence_is_silent_and_a_whisper_in_it_is_not() -> None:
    sound = np.zeros(10 * RATE)
    assert is_silent(sound) and is_silent(sound[:7]) and is_silent(sound[:0])
    sound[RATE : RATE + RATE // 5] = 0.005
    assert not is_silent(sound)


def test_digital_silence_gets_a_little_noise_the_same_at_every_call() -> None:
    heard = np.frombuffer(dithered(np.zeros(RATE)), "<i2")
    assert 2 < heard.std() < 5 and dithered(np.zeros(RATE)) == dithered(np.zeros(RATE))
    assert np.frombuffer(dithered(np.full(9, 7.0)), "<i2").max() == 32_767
