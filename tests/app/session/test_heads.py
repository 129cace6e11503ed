"""Heads are read by file or name, and the one of a kept retarget becomes the take's."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.session import Session
from app.session.heads import HeadFile, KeptHeads, read_head
from engine import assets
from engine.character import bundled, load, save
from engine.errors import EngineError
from engine.formats.characters.opening import SECOND
from engine.formats.characters.reading import Reading
from engine.take import SHAPES, Take
from tests.heads import write_glb

NAMES = {"jawOpen": "jawOpen", "eyeBlinkLeft": "eyeBlinkLeft", "eyeBlinkRight": "eyeBlinkRight"}


def test_the_second_head_is_read_by_its_name_and_others_by_their_file(tmp_path: Path) -> None:
    second = read_head(SECOND, Reading())
    assert second.head.name == "Second head" and second.imported is None
    np.testing.assert_array_equal(second.head.neutral, load(assets.SECOND_HEAD).neutral)
    save(bundled(), tmp_path / "mine.npz")
    assert read_head(tmp_path / "mine.npz", Reading()).head.name == "mine"
    other = read_head(write_glb(tmp_path / "theirs.glb", NAMES), Reading())
    assert other.head.name == "theirs" and other.imported is not None
    with pytest.raises(EngineError):
        read_head(tmp_path / "none.npz", Reading())


def test_a_file_of_that_name_is_read_in_place_of_the_second_head(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save(bundled(), tmp_path / "second.npz")
    (tmp_path / "second").mkdir()
    with pytest.raises(EngineError):
        read_head(SECOND, Reading())  # an empty folder


def test_a_head_is_read_once_then_known_and_none_is_the_bundled_one() -> None:
    session, work, found = Session(Take(np.zeros((4, len(SHAPES))), 30.0)), [], []

    def submit(job: Callable[[], HeadFile], then: Callable[[Any], None]) -> None:
        work.append((job, then))

    kept = KeptHeads(session, submit, lambda: found.append(True))
    kept.follow({"target": "second"})
    kept.follow({"target": "second"})
    assert len(work) == 1 and session.document.character is None  # not read yet
    job, then = work[0]
    then(job())
    assert found == [True]
    kept.follow({"target": "second"})
    head = session.document.character
    assert head is not None and head.name == "Second head" and session.view.head is head and len(work) == 1
    kept.follow({})
    assert session.document.character is None and session.view.head is None


def test_a_take_opened_after_one_on_another_head_is_shown_on_the_bundled_head() -> None:
    session = Session(Take(np.zeros((4, len(SHAPES))), 30.0))
    session.play_on(bundled())
    session.open(Take(np.zeros((4, len(SHAPES))), 30.0), None)
    assert session.document.character is None and session.view.head is None
