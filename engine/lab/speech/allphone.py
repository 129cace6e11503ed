"""Hearing phones in speech of any language, without a transcript: all-phone decoding by the optional PocketSphinx."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from engine.errors import EngineError
from engine.formats import audio
from engine.speech.alphabets import class_anywhere
from engine.speech.sound import RATE, dithered, speech_samples
from engine.speech.visemes import Cue
from engine.take import Array

_FRAME_S = 0.01
_LEAST_S = 0.05  # two windows of the decoder
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
    return heard(speech_samples(sound.samples, sound.rate))


def heard(samples: Array) -> list[Cue]:
    """Return the phones in samples at 16 kHz, (n,) in -1..1; what is too short to hear anything in has none."""
    if len(samples) < _LEAST_S * RATE:
        return []
    decoder = _decoder()
    decoder.start_utt()
    decoder.process_raw(dithered(samples), full_utt=True)
    decoder.end_utt()
    return [
        Cue(part.start_frame * _FRAME_S, (part.end_frame + 1) * _FRAME_S, _phone(part.word))
        for part in decoder.seg() or ()
    ]


def _phone(word: str) -> str:
    return word if class_anywhere(word) not in (None, "sil") else "SIL"


def _decoder() -> Any:
    from pocketsphinx import Decoder, get_model_path

    folder = Path(get_model_path()) / "en-us"
    phones = str(folder / "en-us-phone.lm.bin")
    return Decoder(hmm=str(folder / "en-us"), allphone=phones, lw=_WEIGHT, beam=_BEAM, pbeam=_BEAM, loglevel="FATAL")
