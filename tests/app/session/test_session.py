from __future__ import annotations

from pathlib import Path

import numpy as np
from pytestqt.qtbot import QtBot

from app.session import Change, Session
from engine.character import bundled
from engine.extended import bundled_face
from engine.take import SHAPES, Take


def a_take(frames: int) -> Take:
    return Take(np.full((frames, len(SHAPES)), 0.25), 30.0)


def heard(session: Session) -> list[Change]:
    changes: list[Change] = []
    session.changed.connect(changes.append)
    return changes


def test_what_either_half_tells_the_session_tells(qtbot: QtBot) -> None:
    session = Session(a_take(60))
    changes = heard(session)
    session.view.move_playhead(9)
    session.document.changed.emit(Change.MARKS)
    assert changes == [Change.PLAYHEAD, Change.MARKS]


def test_another_take_is_looked_at_anew_and_told_once(qtbot: QtBot) -> None:
    session = Session(a_take(60))
    session.view.move_playhead(50)
    session.view.select((3, 9))
    changes, take = heard(session), a_take(20)
    measured = bundled_face().measure(take.weights)
    session.open(take, Path("b.csv"), measured)
    assert changes == [Change.TAKE]
    assert session.document.take is take and session.document.path == Path("b.csv")
    assert (session.view.playhead, session.view.selection, session.view.range) == (0, None, (0.0, 19.0))
    np.testing.assert_array_equal(session.document.controls, measured)


def test_a_take_that_is_opened_over_another_head_is_on_the_usual_one_again(qtbot: QtBot) -> None:
    session = Session(a_take(60))
    session.document.character = bundled()
    changes = heard(session)
    session.open(a_take(20), None)
    assert changes[-1] == Change.TAKE | Change.CHARACTER and session.document.character is None
