"""The worker's order of steps, on a decoder that writes down what is asked of it; real speech is in test_hearing."""

from __future__ import annotations

import json
from types import SimpleNamespace as Thing
from typing import Any

import pytest

from engine.speech import worker


class Decoder:
    """Hears "boat" in whatever is not empty, and fails where an utterance was left open."""

    def __init__(self) -> None:
        self.open, self.added, self.text, self.heard = False, [], "", b""

    def add_word(self, word: str, phones: str, update: bool) -> None:
        self.added.append((word, phones))

    def start_utt(self) -> None:
        assert not self.open, "the utterance before was left open"
        self.open, self.heard = True, b""

    def process_raw(self, samples: bytes, *, full_utt: bool) -> None:
        if samples == b"bad":
            raise RuntimeError("no frames")
        self.heard = samples

    def end_utt(self) -> None:
        self.open = False

    def hyp(self) -> Any:
        return Thing(hypstr="boat boat(2)") if self.heard else None

    def set_align_text(self, text: str) -> None:
        self.text = text

    def set_alignment(self) -> None:
        pass

    def get_alignment(self) -> Any:
        class Word(list):
            name = self.text

        return [Word([Thing(name="B", start=2, duration=3, score=-7)])]


@pytest.fixture
def decoder(monkeypatch: pytest.MonkeyPatch) -> Decoder:
    hearing = Decoder()
    monkeypatch.setattr(worker, "_decoder", lambda **_: hearing)
    return hearing


def test_words_are_aligned_part_by_part(decoder: Decoder, capsys: pytest.CaptureFixture[str]) -> None:
    found = worker.align([b"x", b"", b"y"], [["a", "boat"], ["b"], []], {"zorp": ["Z AO", "Z"]}, worker._Steps(3))
    assert found == [[["a boat", [["B", 2, 3, -7]]]], None, None]
    assert decoder.added == [("zorp", "Z AO"), ("zorp(2)", "Z")]
    assert [json.loads(line)["part"] for line in capsys.readouterr().out.splitlines()] == pytest.approx(
        [1 / 3, 2 / 3, 1]
    )


def test_words_are_recognised_without_the_numbers_of_their_ways(decoder: Decoder) -> None:
    assert worker.recognise([b"x", b""], worker._Steps(2)) == [["boat", "boat"], []]


def test_an_utterance_is_ended_whatever_happens(decoder: Decoder) -> None:
    with pytest.raises(RuntimeError):
        worker._hear(decoder, b"bad")
    assert not decoder.open
