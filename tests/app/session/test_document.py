"""The document without a window: what each change tells, and what steps do to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from app.session import Change, Document
from app.session.commands import EditCommand, MarkCommand, ReadingCommand, VisemesCommand, restored
from engine.editing import Patch
from engine.extended import bundled_face
from engine.formats.base.reading import ReadAs, Reading
from engine.project import Marks, Media, Pin, Span, replay
from engine.speech.lane import attached
from engine.speech.visemes import Cue
from engine.take import SHAPES, Take

FRAMES = 40
ROWS = slice(4, 9)


@pytest.fixture
def document() -> Document:
    rng = np.random.default_rng(5)
    lost = np.zeros(FRAMES, bool)
    lost[20:24] = True
    return Document(Take(rng.random((FRAMES, len(SHAPES))), 30.0, lost=lost, name="random"))


@pytest.fixture
def signalled(document: Document) -> list[Change]:
    seen: list[Change] = []
    document.changed.connect(seen.append)
    return seen


def patch(seed: int = 0, start: int = ROWS.start) -> Patch:
    weights = np.random.default_rng(seed).random((5, len(SHAPES)))
    controls = bundled_face().measure(weights)
    asked = np.full_like(controls, np.nan)
    asked[:, 2] = 1.5
    return Patch(start, weights, asked=asked, reached=controls)


def test_an_edit_replaces_its_rows_alone_and_is_taken_back_to_the_bit(
    document: Document, signalled: list[Change]
) -> None:
    before, controls = document.take, document.controls
    document.undo.push(EditCommand.of(document, patch(), "edit"))
    after = document.take
    np.testing.assert_array_equal(after.weights[ROWS], patch().weights)
    rest = np.delete(np.arange(FRAMES), np.arange(FRAMES)[ROWS])
    np.testing.assert_array_equal(after.weights[rest], before.weights[rest])
    assert (document.asked[ROWS, 2] == 1.5).all() and np.isnan(document.asked[rest]).all()
    assert document.touched == (4, 9) and document.edited and signalled[0] == Change.CURVES | Change.DRAFT
    document.undo.undo()
    np.testing.assert_array_equal(document.take.weights, before.weights)
    np.testing.assert_array_equal(document.controls, controls)
    assert np.isnan(document.asked).all() and not document.edited


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        (lambda d: d.set_marks(Marks(pins=(Pin(3, {"jawOpen": 0.5}, 0, 9),))), Change.MARKS),
        (lambda d: d.set_visemes(attached((Cue(0.1, 0.2, "M"),), "a")), Change.VISEMES),
        (lambda d: d.set_draft(patch()), Change.DRAFT),
        (lambda d: d.set_flags(()), Change.FLAGS),
        (lambda d: d.set_differences(((1, 2),)), Change.REVIEW),
        (lambda d: d.play_on(None), Change.CHARACTER),
        (lambda d: d.attach_video(None), Change.MEDIA),
        (lambda d: d.slide("audio", 1.0), Change.MEDIA),
    ],
)
def test_each_change_is_signalled_once(
    document: Document, signalled: list[Change], change: Callable[[Document], None], kind: Change
) -> None:
    change(document)
    assert signalled == [kind]


def test_what_changes_nothing_signals_nothing(document: Document, signalled: list[Change]) -> None:
    document.set_marks(document.marks)
    document.set_visemes(None)
    document.set_differences(None)
    assert signalled == []


def test_opening_signals_nothing_and_forgets_everything_else(document: Document, signalled: list[Change]) -> None:
    document.undo.push(EditCommand.of(document, patch(), "edit"))
    signalled.clear()
    other = Take(np.zeros((7, len(SHAPES))), 24.0)
    document.open(other, None)
    assert signalled == [] and not document.opening
    assert document.take is document.original is document.recorded is other
    assert document.undo.count() == 0 and document.marks == Marks() and document.touched == (0, 7)


def test_lost_spans_are_marked_and_open_until_a_step_gives_them_motion(document: Document) -> None:
    assert document.marks.spans == document.open_spans == (Span(20, 24, kind="lost"),)
    document.undo.push(EditCommand.of(document, patch(start=19), "fill", kind="fill"))
    assert document.open_spans == () and document.marks.spans
    document.undo.undo()
    assert document.open_spans == document.marks.spans


def test_the_draft_is_shown_in_its_frames_alone(document: Document) -> None:
    document.set_draft(patch())
    np.testing.assert_array_equal(document.frame_weights(5), patch().weights[1])
    assert document.value(0, 5) == patch().reached[1, 0]
    for frame in (3, 9):
        np.testing.assert_array_equal(document.frame_weights(frame), document.take.weights[frame])
        assert document.value(0, frame) == document.controls[frame, 0]


def test_steps_from_a_file_do_and_undo_what_those_that_were_made_do(document: Document) -> None:
    reading = ReadAs(Reading(25.0, "named"), 25.0, document.reading.swapped)
    document.undo.push(EditCommand.of(document, patch(1), "edit"))
    document.undo.push(MarkCommand.of(document, replace(document.marks, pins=(Pin(3, {"jawOpen": 0.5}, 0, 9),)), "pin"))
    document.undo.push(VisemesCommand.of(document, attached((Cue(0.1, 0.2, "M"),), "a"), "attach"))
    document.undo.push(ReadingCommand.of(document, reading, "read at 25 fps"))
    document.undo.push(EditCommand.of(document, patch(2, 6), "edit again"))
    document.undo.undo()
    contents = document.contents()
    assert (len(contents.edits), contents.position) == (5, 4)

    again, state = Document(contents.original), replay(contents)
    signalled: list[Change] = []
    again.changed.connect(signalled.append)
    measured = tuple(bundled_face().measure(take.weights) for take in (contents.original, state.take))
    again.restore(contents, None, restored(again, contents, state), state, measured)
    assert signalled == [] and not again.opening and not again.edited
    for go in ("redo", *["undo"] * 5, *["redo"] * 5):
        for each in (document, again):
            getattr(each.undo, go)()
        np.testing.assert_array_equal(again.take.weights, document.take.weights)
        np.testing.assert_array_equal(again.asked, document.asked)
        assert (again.take.fps, again.marks) == (document.take.fps, document.marks)
        cues = [each.visemes.cues if each.visemes is not None else () for each in (document, again)]
        assert cues[0] == cues[1]


def test_while_the_sound_is_dragged_it_begins_where_it_is_shown_and_then_where_it_is_kept(document: Document) -> None:
    document.set_marks(document.marks.with_medium("audio", Media("audio", "a.wav", "ab" * 32, 0.5)))
    assert document.offset_s("audio") == -0.5 and document.offset_s("video") == 0.0
    document.slide("audio", 1.25)
    assert document.offset_s("audio") == 1.25 and document.offset_s("video") == 0.0
    document.slide("audio", None)
    assert document.offset_s("audio") == -0.5
