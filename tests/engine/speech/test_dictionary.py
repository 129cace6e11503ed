from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from engine.speech import dictionary


@pytest.fixture(autouse=True)
def anew() -> None:
    dictionary.dictionary.cache_clear()


def found_in(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dictionary, "find_spec", lambda _: SimpleNamespace(origin=str(folder / "__init__.py")))


def test_ways_to_say_a_word_stand_in_their_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model = tmp_path / "model" / "en-us"
    model.mkdir(parents=True)
    (model / "cmudict-en-us.dict").write_text("read R EH D\nread(2) R IY D\nboat B OW T\n")
    found_in(tmp_path, monkeypatch)
    assert dictionary.installed()
    assert dictionary.dictionary() == {"read": (("R", "EH", "D"), ("R", "IY", "D")), "boat": (("B", "OW", "T"),)}


def test_no_dictionary_is_an_empty_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found_in(tmp_path, monkeypatch)
    assert dictionary.dictionary() == {}
    dictionary.dictionary.cache_clear()
    monkeypatch.setattr(dictionary, "find_spec", lambda _: None)
    assert dictionary.dictionary() == {} and not dictionary.installed()
