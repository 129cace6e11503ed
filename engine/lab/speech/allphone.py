"""Hearing phones in speech of any language, without a transcript: all-phone decoding by the optional PocketSphinx."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from engine.errors import EngineError
from engine.formats import audio
from engine.models.resample import interpolate
from engine.speech.visemes import INDEX, Cue
from engine.take import Array

RATE = 16_000  # Hz, of the acoustic model
_FRAME_S = 0.01
_WEIGHT, _BEAM = 2.0, 1e-20  # as PocketSphinx advises for phones alone


def available() -> bool:
    """Return whether PocketSphinx is installed."""
    from importlib.util import find_spec

    return find_spec("pocketsphinx") is not None


def listen(path: Path) -> list[Cue]:
    """Return the phones of a sound file as an English ear hears them; noises count as silence.

    Raises `FormatError` for what is no sound, and `EngineError` where PocketSphinx is not installed.
    """
    if not available():
        raise EngineError("Hearing phones needs PocketSphinx.", "Install it: pip install 'retake[training]'.")
    sound = audio.read(path)
    samples = np.asarray(sound.samples, np.float64)
    mono = samples.mean(axis=1) if samples.ndim > 1 else samples
    return heard(_at_rate(mono, sound.rate))


def heard(samples: Array) -> list[Cue]:
    """Return the phones in samples at 16 kHz, (n,) in -1..1."""
    decoder = _decoder()
    decoder.start_utt()
    decoder.process_raw((np.clip(samples, -1, 1) * 32767).astype("<i2").tobytes(), full_utt=True)
    decoder.end_utt()
    return [
        Cue(part.start_frame * _FRAME_S, (part.end_frame + 1) * _FRAME_S, _phone(part.word)) for part in decoder.seg()
    ]


def _phone(word: str) -> str:
    return word if word.lower() in INDEX else "SIL"


def _decoder() -> Any:
    from pocketsphinx import Decoder, get_model_path

    folder = Path(get_model_path()) / "en-us"
    phones = str(folder / "en-us-phone.lm.bin")
    return Decoder(hmm=str(folder / "en-us"), allphone=phones, lw=_WEIGHT, beam=_BEAM, pbeam=_BEAM, loglevel="FATAL")


def _at_rate(samples: Array, rate: int) -> Array:
    if rate == RATE:
        return samples
    frames = np.arange(int(len(samples) * RATE / rate)) * rate / RATE
    return interpolate(samples[:, None], np.minimum(frames, len(samples) - 1))[:, 0]
