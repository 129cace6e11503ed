"""Words to phones: by the dictionary of English, and by eSpeak NG for words that it lacks and for other languages."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from engine.errors import EngineError
from engine.speech import espeak
from engine.speech.dictionary import Phones, dictionary
from engine.speech.normalise import Word

ENGLISH = "en-us"
NAMED = 4  # unknown words that a sentence names
_HISSING = frozenset({"S", "Z", "SH", "ZH", "CH", "JH"})
_VOICELESS = frozenset({"P", "T", "K", "F", "TH"})


@dataclass(frozen=True)
class Spoken:
    """A word with how it may be said.

    Attributes
    ----------
    word : as it is said and written
    ways : ARPAbet phones of each way to say it, the usual one first
    found_in : what says so: dictionary or eSpeak
    """

    word: Word
    ways: tuple[Phones, ...]
    found_in: str = "dictionary"


def is_english(language: str) -> bool:
    """Return whether a language's name is one of English."""
    return language.lower().split("-")[0].split("+")[0] == "en"


def pronounce(words: Sequence[Word], language: str = ENGLISH) -> tuple[Spoken, ...]:
    """Return the words with their phones.

    Raises `EngineError` that names the words that nothing here can pronounce, and what would help.
    """
    known = dictionary() if is_english(language) else {}
    ways = {word.spoken: _looked_up(word.spoken, known) for word in words}
    missing = [word for word, found in ways.items() if not found]
    if missing and espeak.installed():
        spelled = dict(zip(missing, espeak.pronounced(missing, language), strict=True))
    elif missing:
        raise _unknown(missing, language)
    else:
        spelled = {}
    if silent := [word for word, phones in spelled.items() if not phones]:
        raise EngineError(f"Nothing says how {_listed(silent)} is pronounced.", "Write it as it sounds.")
    return tuple(
        Spoken(word, (spelled[word.spoken],), "eSpeak") if word.spoken in spelled else Spoken(word, ways[word.spoken])
        for word in words
    )


def _looked_up(word: str, known: Mapping[str, tuple[Phones, ...]]) -> tuple[Phones, ...]:
    bare = "".join(mark for mark in unicodedata.normalize("NFD", word) if unicodedata.category(mark) != "Mn")
    for text in (word, bare):
        if text in known:
            return known[text]
        if text.removesuffix("'") in known:
            return known[text.removesuffix("'")]
        if (stem := text.removesuffix("'s")) != text and stem in known:
            return tuple((*way, *_possessive(way[-1])) for way in known[stem])
    return ()


def _possessive(last: str) -> Phones:
    """Return how an 's sounds behind a phone."""
    return ("IH", "Z") if last in _HISSING else ("S",) if last in _VOICELESS else ("Z",)


def _unknown(missing: Sequence[str], language: str) -> EngineError:
    if not is_english(language):
        return EngineError(
            f"Words in the language {language!r} need eSpeak NG, which is not installed.",
            "Install it (on Debian: apt install espeak-ng); a TextGrid or mouth cues still work in any language.",
        )
    if not dictionary():
        return EngineError(
            "To pronounce words Retake needs PocketSphinx's dictionary or eSpeak NG; neither is installed.",
            "Install one: pip install 'retake[speech]', or apt install espeak-ng. TextGrids and mouth cues still work.",
        )
    return EngineError(
        f"The dictionary does not have {_listed(missing)}.",
        "Write it as it sounds, or install eSpeak NG, which pronounces any word.",
    )


def _listed(words: Sequence[str]) -> str:
    return ", ".join(repr(word[:20]) for word in words[:NAMED]) + ("…" if len(words) > NAMED else "")
