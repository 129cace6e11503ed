"""Steps alone, on a document without a window."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest

from app.session import Document
from app.session.commands import AlignCommand, EditCommand, MarkCommand, put_marks
from engine.editing import Patch
from engine.extended import bundled_face
from engine.project import ALIGN, Edit, Marks, Media, Pin
from engine.take import SHAPES, Take

FRAMES, ROWS = 40, slice(4, 9)
SOUND, OTHER = (Media("audio", name, "ab" * 32, 0.0) for name in ("a.wav", "b.wav"))
FILM = Media("video", "a.mp4", "cd" * 32, 0.0)
PINNED = Marks(pins=(Pin(5, {"jawOpen": 0.5}, 0, 9),))


@pytest.fixture
def document() -> Document:
    rng = np.random.default_rng(5)
    lost = np.zeros(FRAMES, bool)
    lost[20:24] = True
    return Document(Take(rng.random((FRAMES, len(SHAPES))), 30.0, lost))


def a_patch(*, asks: bool = True) -> Patch:
    weights = np.random.default_rng(1).random((5, len(SHAPES)))
    reached = bundled_face().measure(weights)
    asked = np.full_like(reached, np.nan)
    if asks:
        asked[1:3, 4] = 12.0
    return Patch(ROWS.start, weights, asked, reached, granted=reached + 1)


def test_a_drag_tells_which_curves_it_asked_for_and_other_edits_none(document: Document) -> None:
    document.asked[ROWS, 2] = 7.0  # by an edit before
    patch = a_patch()
    step = EditCommand.of(document, patch, "drag", inputs={"believability": 0.5})
    assert step.asked is not None and step.asked[0] == ROWS.start
    np.testing.assert_array_equal(step.asked[1], patch.asked)
    assert EditCommand.of(document, patch, "smooth", kind="smooth", inputs={"cutoff_hz": 4}).asked is None
    np.testing.assert_array_equal(step.granted, patch.granted)
    assert step.text() == "drag"


def test_what_was_asked_before_stays_asked_where_nothing_new_is(document: Document) -> None:
    document.asked[ROWS, 2] = 7.0
    step = EditCommand.of(document, a_patch(), "drag")
    controls, had = document.controls[ROWS].copy(), document.asked[ROWS].copy()
    document.undo.push(step)
    np.testing.assert_array_equal(document.asked[ROWS, 2], 7.0)
    np.testing.assert_array_equal(document.asked[5:7, 4], 12.0)
    assert np.isnan(document.asked[[4, 7, 8], 4]).all()
    np.testing.assert_array_equal(step.before[0], controls)
    np.testing.assert_array_equal(step.before[1], had)
    document.undo.undo()
    np.testing.assert_array_equal(document.asked[ROWS], had)
    np.testing.assert_array_equal(document.controls[ROWS], controls)


def test_an_edit_s_marks_come_and_go_with_it(document: Document) -> None:
    before = document.marks
    document.undo.push(EditCommand.of(document, a_patch(), "fill", marks=PINNED))
    assert document.marks == PINNED
    document.undo.undo()
    assert document.marks == before
    document.undo.redo()
    assert document.marks == PINNED
    document.undo.push(EditCommand.of(document, a_patch(), "drag"))
    assert document.marks == PINNED
    document.undo.undo()
    assert document.marks == PINNED


def test_sound_that_was_found_meanwhile_outlives_undoing_a_step_that_is_not_about_it(document: Document) -> None:
    before = document.marks
    document.undo.push(MarkCommand.of(document, PINNED, "pin"))
    document.set_marks(document.marks.with_medium("audio", SOUND))
    document.undo.undo()
    assert document.marks == before.with_medium("audio", SOUND)
    document.undo.redo()
    assert document.marks.pins == PINNED.pins and document.marks.medium("audio") == SOUND


def test_a_step_about_the_sound_changes_it_and_leaves_the_film(document: Document) -> None:
    document.set_marks(Marks(media=(SOUND,)))
    put_marks(document, Marks(media=(OTHER,)), instead_of=Marks(media=(SOUND,)))
    assert document.marks.medium("audio") == OTHER
    document.set_marks(document.marks.with_medium("video", FILM))
    put_marks(document, Marks(), instead_of=Marks(media=(OTHER,)))
    assert document.marks.medium("audio") is None and document.marks.medium("video") == FILM


def test_a_take_before_at_another_time_comes_and_goes(document: Document) -> None:
    before = document.original
    weights = np.roll(before.weights, 3, axis=0)
    lost = np.arange(FRAMES) < 3
    edit = Edit(ALIGN, "align", 0, weights, np.full((FRAMES, 16), np.nan), {}, lost)
    document.undo.push(AlignCommand.of(document, edit))
    np.testing.assert_array_equal(document.original.weights, weights)
    np.testing.assert_array_equal(document.original.lost, lost)
    document.undo.undo()
    np.testing.assert_array_equal(document.original.weights, before.weights)
    np.testing.assert_array_equal(document.original.lost, before.lost)


def test_a_step_does_not_keep_its_document_alive() -> None:
    document = Document(Take(np.zeros((FRAMES, len(SHAPES))), 30.0))
    step, gone = EditCommand.of(document, a_patch(), "drag"), weakref.ref(document)
    del document
    gc.collect()
    assert gone() is None and step.edit.title == "drag"
