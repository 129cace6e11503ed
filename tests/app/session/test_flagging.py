from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.session import Session
from app.session.commands import EditCommand, VisemesCommand
from app.session.flagging import Flagging
from engine.editing import Patch
from engine.formats import read_take
from engine.formats.audio import Audio
from engine.lab.performer import demo
from engine.quality import flags_of, seen_of
from engine.retouch import paste
from engine.speech.lane import attached
from engine.speech.visemes import Cue
from engine.take import Take


@pytest.fixture
def session(qtbot: QtBot) -> Iterator[Session]:
    opened = Session(read_take(demo.BUNDLED))
    flagging = Flagging(opened)
    opened.flagging = flagging
    yield opened
    flagging.close()


def up_to_date(qtbot: QtBot, session: Session) -> bool:
    def so() -> bool:
        seen = seen_of(
            session.document.take, session.document.original, session.document.asked, session.document.visemes
        )
        return session.document.flags == flags_of(seen)

    qtbot.waitUntil(so, timeout=10_000)
    return True


def wild(session: Session, seed: int) -> Patch:
    rng = np.random.default_rng(seed)
    start = int(rng.integers(0, 260))
    made = paste(session.document.take, start, rng.random((int(rng.integers(2, 60)), 52)))
    return Patch(made.start, made.weights, made.reached + rng.normal(0, 3, made.reached.shape), made.reached)


def test_flags_follow_every_edit_and_every_step_back(qtbot: QtBot, session: Session) -> None:
    assert up_to_date(qtbot, session)
    assert [flag.kind for flag in session.document.flags or ()] == ["lost"]
    for seed in range(6):
        session.document.undo.push(EditCommand.of(session.document, wild(session, seed), "wild"))
        if seed % 2:
            assert up_to_date(qtbot, session)
    assert up_to_date(qtbot, session) and len(session.document.flags or ()) > 10
    session.document.undo.push(
        VisemesCommand.of(session.document, attached([Cue(2.0, 2.2, "M"), Cue(5.0, 5.3, "B")], "a"), "attach")
    )
    assert up_to_date(qtbot, session)
    for _ in range(3):
        session.document.undo.undo()
    assert up_to_date(qtbot, session)
    session.document.undo.setIndex(0)
    assert up_to_date(qtbot, session) and [flag.kind for flag in session.document.flags or ()] == ["lost"]


def test_flags_of_a_closed_take_never_come(qtbot: QtBot, session: Session) -> None:
    for frames in (300, 20, 100):
        session.open(Take(weights=np.full((frames, 52), 0.5), fps=30.0), None)
        assert session.document.flags is None
    assert up_to_date(qtbot, session)
    assert all(flag.stop <= 100 for flag in session.document.flags or ())


def test_a_take_filled_where_it_was_lost_has_no_flag_there(qtbot: QtBot, session: Session) -> None:
    filled = Patch.between(
        session.document.take,
        session.document.take.with_rows(252, session.document.take.weights[252:276] + 0.01),
        (252, 276),
    )
    session.document.undo.push(EditCommand.of(session.document, filled, "fill"))
    assert up_to_date(qtbot, session) and not session.document.flags


def test_sound_that_is_attached_is_listened_to_and_forgotten_once_it_is_detached(
    qtbot: QtBot, session: Session
) -> None:
    assert up_to_date(qtbot, session)
    silence = np.zeros(round(8_000 * (session.document.take.duration_s + 1)), np.float32)
    session.document.attach_audio(Audio(silence, 8_000))
    qtbot.waitUntil(lambda: "short" in {flag.kind for flag in session.document.flags or ()}, timeout=10_000)
    session.document.attach_audio(None)
    assert up_to_date(qtbot, session)
