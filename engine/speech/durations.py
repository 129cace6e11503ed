"""How long each phone lasts where nobody has said it yet: the rules of Klatt (1979), at any rate of speech.

A phone lasts min + (inherent − min)·p, p being the product of the rules that hold for it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from engine.errors import EditError
from engine.speech.normalise import words_of
from engine.speech.pronounce import ENGLISH, Spoken, pronounce
from engine.speech.transcript import Said, Transcript
from engine.speech.visemes import Cue

# Inherent and least duration in ms (Klatt 1979, Allen, Hunnicutt and Klatt 1987), of read American English.
_MS = {
    **{"AA": (240, 100), "AE": (230, 80), "AH": (140, 60), "AO": (240, 100), "AW": (260, 100), "AY": (250, 150)},
    **{"EH": (150, 70), "ER": (180, 80), "EY": (190, 70), "IH": (135, 40), "IY": (155, 55), "OW": (220, 80)},
    **{"OY": (280, 150), "UH": (160, 60), "UW": (210, 70), "HH": (80, 20), "L": (80, 40), "R": (80, 30)},
    **{"W": (80, 60), "Y": (80, 40), "M": (70, 60), "N": (60, 50), "NG": (95, 60), "DH": (50, 30), "F": (100, 80)},
    **{"S": (105, 60), "SH": (105, 80), "TH": (90, 60), "V": (60, 40), "Z": (75, 40), "ZH": (70, 40), "B": (85, 60)},
    **{"CH": (70, 50), "D": (75, 50), "G": (80, 60), "JH": (70, 50), "K": (80, 60), "P": (90, 50), "T": (75, 50)},
}
_VOWELS = frozenset(["AA", "AE", "AH", "AO", "AW", "AY", "EH", "ER", "EY", "IH", "IY", "OW", "OY", "UH", "UW"])
_PAUSE_S = {"short": 0.2, "long": 0.4}
RATES = (0.3, 3.0)


@dataclass(frozen=True)
class Rules:
    """Klatt's rules as far as a dictionary without stress tells where they hold; none is fitted.

    Attributes
    ----------
    phrase_end : of the last syllable before a pause
    within_phrase, within_word : of vowels in other words, and in other syllables than a word's last
    long_word : of vowels in words of several syllables
    inside : of consonants that do not begin a word
    voiceless, voiced : of vowels before a stop or fricative of the kind, in the last syllable
    cluster : of a consonant beside another
    reduced : of AH in words of several syllables, which is mostly unstressed
    """

    phrase_end: float = 1.4
    within_phrase: float = 0.6
    within_word: float = 0.85
    long_word: float = 0.8
    inside: float = 0.85
    voiceless: float = 0.7
    voiced: float = 1.2
    cluster: float = 0.7
    reduced: float = 0.7


RULES = Rules()
_VOICELESS = frozenset(["P", "T", "K", "F", "TH", "S", "SH", "CH"])
_VOICED = frozenset(["B", "D", "G", "V", "DH", "Z", "ZH", "JH"])


def laid_out(text: str, *, rate: float = 1.0, language: str = ENGLISH) -> Transcript:
    """Return the words and phones of a text as somebody would read it, `rate` times as fast, from time 0.

    Raises `EngineError` for a text without words, words that nothing can pronounce, and a rate out of 0.3..3.
    """
    if not RATES[0] <= rate <= RATES[1]:
        raise EditError(f"Speech is laid out at {RATES[0]} to {RATES[1]} times the usual rate, not {rate:g}.")
    said: list[Said] = []
    cues: list[Cue] = []
    at_s = 0.0
    spoken = pronounce(words_of(text), language)
    for each, is_last in _with_ends(spoken):
        ends = np.cumsum(durations_s(each.ways[0], is_last=is_last)) / rate + at_s
        times = np.concatenate([[at_s], ends]).tolist()
        mine = tuple(map(Cue, times[:-1], times[1:], each.ways[0]))
        said.append(Said(each.word.written, at_s, times[-1], 1.0, mine))
        cues += mine
        at_s = times[-1]
        if each.word.pause and each is not spoken[-1]:
            cues.append(Cue(at_s, at_s + _PAUSE_S[each.word.pause] / rate, "SIL"))
            at_s = cues[-1].stop_s
    return Transcript(tuple(said), tuple(cues), at_s)


def rate_of(transcript: Transcript) -> float:
    """Return how many times as fast as the rules somebody speaks, 0.3..3, pauses left out; 1 where nothing is said."""
    words = [each for each in transcript.said if each.phones]
    usual = sum(float(durations_s([cue.label for cue in each.phones], is_last=False).sum()) for each in words)
    lasts = sum(each.phones[-1].stop_s - each.phones[0].start_s for each in words)
    return float(np.clip(usual / lasts, *RATES)) if lasts > 0 and usual > 0 else 1.0


def durations_s(phones: Sequence[str], *, is_last: bool) -> np.ndarray:
    """Return the seconds that each phone of a word lasts, (phones,), `is_last` before a pause."""
    vowels = [at for at, phone in enumerate(phones) if phone in _VOWELS]
    last_vowel = vowels[-1] if vowels else -1
    lasting = []
    for at, phone in enumerate(phones):
        inherent, least = _MS.get(phone, _MS["AH"])
        ends = is_last and at >= last_vowel
        parts = _of_vowel(phones, at, vowels) if phone in _VOWELS else _of_consonant(phones, at)
        share = float(np.prod([*parts, RULES.phrase_end if ends else 1.0]))
        if phone in _VOWELS and not ends:
            share *= RULES.within_phrase
        lasting.append((least + (inherent - least) * share) / 1000)
    return np.array(lasting)


def _of_vowel(phones: Sequence[str], at: int, vowels: Sequence[int]) -> Iterator[float]:
    after = phones[at + 1] if at + 1 < len(phones) else ""
    if len(vowels) > 1:
        yield RULES.long_word
        if phones[at] == "AH":
            yield RULES.reduced
    if at != vowels[-1]:
        yield RULES.within_word
    elif after in _VOICELESS:
        yield RULES.voiceless
    elif after in _VOICED:
        yield RULES.voiced


def _of_consonant(phones: Sequence[str], at: int) -> Iterator[float]:
    if at:
        yield RULES.inside
    beside = (*phones[max(at - 1, 0) : at], *phones[at + 1 : at + 2])
    if any(phone not in _VOWELS for phone in beside):
        yield RULES.cluster


def _with_ends(spoken: Sequence[Spoken]) -> Iterator[tuple[Spoken, bool]]:
    """Yield each word with whether a pause or the end follows it."""
    for at, each in enumerate(spoken):
        yield each, bool(each.word.pause) or at == len(spoken) - 1
