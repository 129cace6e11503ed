from __future__ import annotations

import pytest

from engine.errors import EngineError
from engine.speech import espeak, pronounce
from engine.speech.normalise import words_of

KNOWN = {"boat": (("B", "OW", "T"),), "bus": (("B", "AH", "S"),), "dog": (("D", "AO", "G"),), "cafe": (("K", "AE"),)}


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pronounce, "dictionary", lambda: KNOWN)
    monkeypatch.setattr(espeak, "installed", lambda: False)


def ways(text: str) -> list[tuple[str, ...]]:
    return [spoken.ways[0] for spoken in pronounce.pronounce(words_of(text))]


def test_words_and_their_possessives_are_said_as_the_dictionary_says() -> None:
    assert ways("Boat bus's dog's boat's") == [
        ("B", "OW", "T"),
        ("B", "AH", "S", "IH", "Z"),
        ("D", "AO", "G", "Z"),
        ("B", "OW", "T", "S"),
    ]


def test_an_accent_hides_no_word() -> None:
    assert ways("café") == [("K", "AE")]


def test_words_that_nothing_knows_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(EngineError, match="'zorp', 'quux'"):
        ways("boat zorp quux")
    monkeypatch.setattr(pronounce, "dictionary", dict)
    with pytest.raises(EngineError, match="PocketSphinx's dictionary or eSpeak NG"):
        ways("boat")
    with pytest.raises(EngineError, match="'de' need eSpeak NG"):
        pronounce.pronounce(words_of("Boot"), "de")


def test_what_the_dictionary_lacks_espeak_says(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(espeak, "installed", lambda: True)
    monkeypatch.setattr(espeak, "pronounced", lambda words, language: [("Z", "AO", "R", "P") for _ in words])
    boat, zorp = pronounce.pronounce(words_of("boat zorp"))
    assert (boat.found_in, zorp.found_in, zorp.ways) == ("dictionary", "eSpeak", (("Z", "AO", "R", "P"),))
    monkeypatch.setattr(espeak, "pronounced", lambda words, language: [() for _ in words])
    with pytest.raises(EngineError, match="Nothing says how 'zorp'"):
        pronounce.pronounce(words_of("zorp"))


@pytest.mark.parametrize(
    ("language", "english"), [("en", True), ("EN-gb", True), ("en+f2", True), ("eng", False), ("de", False)]
)
def test_english_is_told_by_its_name(language: str, english: bool) -> None:
    assert pronounce.is_english(language) is english
