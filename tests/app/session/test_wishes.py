"""Drags that overlap are one wish of the take below them."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtGui import QUndoCommand
from pytestqt.qtbot import QtBot

from app.session import Session
from app.session.asked import Base
from app.session.wishes import Wishes
from engine.take import SHAPES, Take


@pytest.fixture
def session(qtbot: QtBot) -> Session:
    return Session(Take(np.random.default_rng(4).random((60, len(SHAPES))), 30.0))


def curves(session: Session, start: int, stop: int, column: int, by: float) -> np.ndarray:
    asked = session.document.controls[start:stop].copy()
    asked[:, column] += by
    return asked


def test_a_first_request_covers_the_differing_frames_alone(session: Session) -> None:
    base, wish = Wishes(session).asking(10, curves(session, 10, 20, 0, 2.0))
    assert base.take is session.document.take and wish.frames == (10, 20)
    assert not np.isnan(wish.asked[:, 0]).any() and np.isnan(wish.asked[:, 1:]).all()


@pytest.mark.parametrize(
    ("start", "stop", "joined"), [(15, 25, (10, 25)), (5, 12, (5, 22)), (0, 30, (0, 30)), (22, 30, None), (2, 10, None)]
)
def test_a_wish_that_overlaps_the_last_step_is_asked_with_it_of_the_take_below(
    session: Session, start: int, stop: int, joined: tuple[int, int] | None
) -> None:
    wishes, below = Wishes(session), Base.of(session.document)
    base, first = wishes.asking(12, curves(session, 12, 20, 0, 2.0))
    step = QUndoCommand("drag")
    session.document.undo.push(step)
    wishes.kept(step, base, first, start=10, stop=22)  # which moved a few frames beside it
    _, second = wishes.asking(start, curves(session, start, stop, 1, 1.0))
    assert second.frames == (joined or (start, stop))
    if joined is not None:
        inside = slice(12 - joined[0], 20 - joined[0])
        np.testing.assert_array_equal(second.asked[inside, 0], first.asked[:, 0])
        rows = slice(start - joined[0], stop - joined[0])
        np.testing.assert_array_equal(second.asked[rows, 1], session.document.controls[start:stop, 1] + 1.0)
    assert wishes.asking(start, curves(session, start, stop, 1, 1.0))[0].take is below.take


def test_what_was_undone_or_asked_with_another_believability_stands_alone(session: Session) -> None:
    wishes = Wishes(session)
    base, first = wishes.asking(12, curves(session, 12, 20, 0, 2.0))
    step = QUndoCommand("drag")
    session.document.undo.push(step)
    wishes.kept(step, base, first, start=12, stop=20)
    session.view.set_brush(believability=0.0)
    assert wishes.asking(10, curves(session, 10, 20, 1, 1.0))[1].frames == (10, 20)
    session.view.set_brush(believability=first.believability)
    assert np.isfinite(wishes.asking(10, curves(session, 10, 20, 1, 1.0))[1].asked[5, 0])
    session.document.undo.undo()
    assert np.isnan(wishes.asking(10, curves(session, 10, 20, 1, 1.0))[1].asked[5, 0])
    session.document.undo.redo()
    wishes.forget()
    assert np.isnan(wishes.asking(10, curves(session, 10, 20, 1, 1.0))[1].asked[5, 0])
