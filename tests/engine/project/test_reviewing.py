from __future__ import annotations

import json
import re
from dataclasses import asdict, replace
from datetime import UTC, datetime

import pytest

from engine.project.reviewing import (
    Drawing,
    Note,
    Reply,
    Verdict,
    drawing_of,
    note_of,
    replies_of,
    stamp,
    verdict_from,
)
from tests.engine.project.projects import MARKS


def test_a_note_survives_being_written_as_json() -> None:
    for note in MARKS.notes:
        assert note_of(json.loads(json.dumps(asdict(note)))) == note


def test_a_note_of_an_older_project_has_neither_replies_nor_a_drawing() -> None:
    old = {"frame": 3, "author": "Ana", "time": "2025-01-02T03:04:05Z", "text": "lips"}
    assert note_of(old) == Note(3, "Ana", "2025-01-02T03:04:05Z", "lips")
    assert note_of(old).drawing is None and note_of(old).replies == ()


@pytest.mark.parametrize(
    "stored", [{}, {"frame": 3}, {"frame": 3, "author": "", "time": "", "text": "", "colour": "red"}]
)
def test_what_is_no_note_is_refused(stored: dict[str, object]) -> None:
    with pytest.raises(TypeError):
        note_of(stored)


def test_what_is_no_drawing_or_reply_is_refused() -> None:
    assert drawing_of(None) is None
    assert drawing_of({"strokes": [[[0, 1], [2, 3]]], "camera": [1.0]}) == Drawing((((0, 1), (2, 3)),), (1.0,))
    for missing in ("strokes", "camera"):
        stored = {"strokes": [], "camera": []}
        del stored[missing]
        with pytest.raises(KeyError):
            drawing_of(stored)
    for wrong in ({"strokes": [[1.0]], "camera": []}, {"strokes": [], "camera": None}):
        with pytest.raises(TypeError):
            drawing_of(wrong)
    assert replies_of([{"author": "B", "time": "t", "text": "why?"}]) == (Reply("B", "t", "why?"),)
    with pytest.raises(TypeError):
        replies_of([{"author": "B"}])


def test_a_note_ends_after_its_frames_and_is_resolved_once_somebody_called_it_done() -> None:
    note = Note(7, "Ana", "t", "lips")
    assert (note.stop, replace(note, frames=5).stop) == (8, 12)
    assert not note.resolved and not replace(note, resolved_by="B").resolved and replace(note, resolved_at="t").resolved


@pytest.mark.parametrize(
    ("judgement", "why"), [("Approved", ""), ("Needs work", "the jaw: it pops"), ("Approved", "a")]
)
def test_a_verdict_s_sentence_reads_back(judgement: str, why: str) -> None:
    verdict = Verdict(judgement, why)
    assert verdict.sentence == (f"{judgement}: {why}" if why else judgement)
    assert verdict_from(verdict.sentence) == (verdict,)
    assert verdict_from("") == ()


def test_a_stamp_is_now_to_the_second_with_its_zone() -> None:
    text = stamp()
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00", text)
    assert abs((datetime.now(UTC) - datetime.fromisoformat(text)).total_seconds()) < 60
