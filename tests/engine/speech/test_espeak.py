from __future__ import annotations

import shutil

import pytest

from engine.errors import EditError, EngineError
from engine.speech import espeak


@pytest.mark.parametrize(
    ("ipa", "phones"),
    [
        ("b_əʊ_t", ("B", "OW", "T")),
        ("tʃ_ˈɜː_tʃ", ("CH", "ER", "CH")),
        ("(de)_ɲ_a_(en-us)", ("N", "Y", "AA")),  # where it changes its language
        ("ts_x", ("T", "S", "HH")),
        ("☃", ()),
        ("", ()),
    ],
)
def test_symbols_become_the_nearest_phones_of_english(ipa: str, phones: tuple[str, ...]) -> None:
    assert espeak.arpabet(ipa) == phones


def test_the_longest_piece_that_is_known_is_taken_first() -> None:
    assert espeak.arpabet("aɪə") == ("AY", "AH") and espeak.arpabet("aɪ_ə") == ("AY", "AH")
    assert espeak.arpabet("dʒ") == ("JH",) and espeak.arpabet("d_ʒ") == ("D", "ZH")


def test_nothing_is_run_for_no_words_and_no_option_for_a_language(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(espeak, "_run", lambda *_: pytest.fail("it was run"))
    assert espeak.pronounced([]) == []
    for language in ("--help", "en us", "x" * 40, ""):
        with pytest.raises(EditError, match="not the name of a language"):
            espeak.pronounced(["boat"], language)


def test_a_program_that_is_not_there_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    assert not espeak.installed()
    with pytest.raises(EngineError, match="not installed"):
        espeak.pronounced(["boat"])


def test_a_word_in_two_lines_is_asked_for_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def run(_: list[str], text: str, language: str) -> str:
        asked.append(text)
        return "b_əʊ_t\nk_æ\nt" if text.count("\n") == 2 else {"boat": "b_əʊ_t", "it's": "ɪ_t_s"}[text]

    monkeypatch.setattr(espeak, "_run", run)
    assert espeak.pronounced(["boat", "it's!"]) == [("B", "OW", "T"), ("IH", "T", "S")]
    assert asked == ["boat\nit's\n", "boat", "it's"]


def test_a_tap_is_an_r_but_in_english(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(espeak, "_run", lambda *_: "ɾ")
    assert espeak.pronounced(["r"], "es") == [("R",)] and espeak.pronounced(["r"], "en-us") == [("D",)]
