"""What is lost, what was given motion since, and what undoing brings back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.session import Session
from app.session.commands import EditCommand, restored
from engine import project
from engine.editing import ControlRequest, Patch, set_control
from engine.formats import read_take, write_take
from engine.inpaint.fill import fill
from engine.project import Project, Span, replay
from engine.take import Take, runs
from tests.engine.formats.livelink.files import Writer, content_of

GAP, ROWS = (40, 85), (100, 112)  # without a row; rows without a face


@pytest.fixture
def session(qtbot: QtBot, tmp_path: Path) -> Session:
    lost, absent = np.zeros(150, bool), np.zeros(150, bool)
    lost[slice(*ROWS)], absent[slice(*GAP)] = True, True
    (tmp_path / "take.csv").write_bytes(content_of(Writer(), lost, absent, 4))
    return Session(read_take(tmp_path / "take.csv"))


def pushed(session: Session, patch: Patch, kind: str = "drag") -> None:
    session.document.undo.push(EditCommand.of(session.document, patch, kind, kind=kind))


def written(take: Take, folder: Path) -> Take:
    """Return what a reader finds in the file that a take is written to, which must be the take."""
    write_take(take, folder / "out.csv")
    again = read_take(folder / "out.csv")
    np.testing.assert_array_equal(again.lost, take.lost)
    np.testing.assert_allclose(again.weights, take.weights, atol=1e-9)
    return again


def test_gaps_and_rows_without_a_face_are_spans(session: Session) -> None:
    assert session.document.marks.spans == (Span(*GAP, kind="lost"), Span(*ROWS, kind="lost"))


def test_each_step_and_each_undo_says_what_is_lost(session: Session, tmp_path: Path) -> None:
    states = [session.document.take]
    pushed(
        session, Patch.between(session.document.take, fill(session.document.take, (40, 60))[0].take, (40, 60)), "fill"
    )
    states.append(session.document.take)
    pushed(session, set_control(session.document.take, ControlRequest("lips_vertical", (104, 108), "add", 4.0)))
    states.append(session.document.take)
    assert runs(states[1].lost) == [(60, 85), ROWS] and states[2].lost.sum() < states[1].lost.sum()
    for state in states:
        written(state, tmp_path)
    for state in reversed(states[:2]):
        session.document.undo.undo()
        np.testing.assert_array_equal(session.document.take.lost, state.lost)
        np.testing.assert_array_equal(session.document.take.weights, state.weights)
    write_take(session.document.take, tmp_path / "back.csv")
    assert (tmp_path / "back.csv").read_bytes() == (tmp_path / "take.csv").read_bytes()
    session.document.undo.redo()
    np.testing.assert_array_equal(session.document.take.lost, states[1].lost)


def test_a_project_brings_back_what_is_lost_at_every_step(session: Session, tmp_path: Path) -> None:
    states = [session.document.take]
    for span in (ROWS, GAP):
        pushed(session, Patch.between(session.document.take, fill(session.document.take, span)[0].take, span), "fill")
        states.append(session.document.take)
    project.create(tmp_path / "a.retake", session.document.contents()).close()
    opened = Project.open(tmp_path / "a.retake")
    contents, state = opened.contents, replay(opened.contents)
    opened.close()
    again = Session(contents.original)
    steps = tuple(restored(again.document, contents, state))
    again.restore(contents, None, steps, state, (session.document.original_controls, session.document.controls))
    for before in reversed(states):
        np.testing.assert_array_equal(again.document.take.lost, before.lost)
        np.testing.assert_array_equal(again.document.take.weights, before.weights)
        write_take(again.document.take, tmp_path / "one.csv")
        write_take(before, tmp_path / "two.csv")
        assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()
        again.document.undo.undo()
