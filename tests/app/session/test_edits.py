"""From a wish to an undo step: latest wins, what is outdated stops, and a project can do each step again."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.session import Change, Session
from app.session.asked import LARGEST_KEPT, Asked, Base
from app.session.commands import EditCommand
from app.session.edits import Editing, Runner, Tell
from engine.editing import (
    CleanRequest,
    Editor,
    PasteRequest,
    Patch,
    PinRequest,
    SmoothRequest,
    WeightRequest,
    restored,
)
from engine.errors import EditError
from engine.take import SHAPES, Take


@pytest.fixture
def session(qtbot: QtBot) -> Session:
    rng = np.random.default_rng(4)
    weights = np.clip(0.2 + np.cumsum(rng.normal(0, 0.01, (150, len(SHAPES))), axis=0), 0, 1)
    return Session(Take(weights, 30.0, name="slow"))


@pytest.fixture
def editing(session: Session) -> Iterator[Editing]:
    made = Editing(session)
    yield made
    made.close()


class Work:
    """Answers wishes when it is let, one after the other, and remembers which were begun."""

    def __init__(self) -> None:
        self.begun: list[Asked] = []
        self.let = threading.Semaphore(0)
        self.patient = True  # asks nobody whether to go on

    def __call__(self, asked: Asked, tell: Tell) -> Asked:
        self.begun.append(asked)
        self.let.acquire()
        if not self.patient:
            tell(0.5)
        return asked


def a_wish(session: Session, cutoff_hz: float = 4.0, title: str = "smooth") -> Asked:
    return Asked("smooth", SmoothRequest((20, 40), cutoff_hz), Base.of(session.document), title)


@pytest.fixture
def work() -> Work:
    return Work()


@pytest.fixture
def runner(session: Session, work: Work) -> Iterator[Runner]:
    made = Runner(session, work, name="test")
    yield made
    for _ in range(10):
        work.let.release()
    made.close()


def test_the_latest_wish_wins_and_those_between_are_never_begun(
    qtbot: QtBot, session: Session, runner: Runner, work: Work
) -> None:
    arrived: list[Asked] = []
    runner.arrived.connect(lambda asked, _: arrived.append(asked))
    first, between, last = (a_wish(session, hz) for hz in (3.0, 4.0, 5.0))
    runner.ask(first)
    qtbot.waitUntil(lambda: work.begun == [first])
    for wish in (between, last):
        runner.ask(wish)
    work.let.release()
    work.let.release()
    qtbot.waitUntil(lambda: arrived[-1:] == [last])
    assert work.begun == [first, last] and arrived == [first, last]  # a finished result shows progress


def test_replaced_work_stops_where_it_reports_its_progress(
    qtbot: QtBot, session: Session, runner: Runner, work: Work
) -> None:
    arrived: list[Asked] = []
    runner.arrived.connect(lambda asked, _: arrived.append(asked))
    work.patient = False
    first, last = a_wish(session, 3.0), a_wish(session, 5.0)
    runner.ask(first)
    qtbot.waitUntil(lambda: work.begun == [first])
    runner.ask(last)
    work.let.release()
    qtbot.waitUntil(lambda: work.begun == [first, last])
    with qtbot.waitSignal(runner.progress, timeout=10_000):
        work.let.release()
    qtbot.waitUntil(lambda: arrived == [last])


def test_nothing_arrives_after_a_cancel_or_of_a_closed_take(
    qtbot: QtBot, session: Session, runner: Runner, work: Work
) -> None:
    arrived: list[Asked] = []
    runner.arrived.connect(lambda asked, _: arrived.append(asked))
    done: list[object] = []
    runner._work.done.connect(lambda request, _: done.append(request))
    runner.ask(a_wish(session))
    runner.drop()
    work.let.release()
    qtbot.waitUntil(lambda: len(done) == 1)
    runner.ask(a_wish(session))
    session.open(Take(session.document.take.weights[:50], 30.0), None)
    work.let.release()
    qtbot.waitUntil(lambda: len(done) == 2)
    assert arrived == [] and runner.last is not None


def test_a_wish_by_another_title_is_still_the_last(session: Session, runner: Runner) -> None:
    wish = a_wish(session)
    runner.last = replace(wish, title="another")
    assert runner.is_last(wish) and not runner.is_last(a_wish(session))
    runner.drop()
    assert not runner.is_last(wish)


def test_a_kept_wish_is_a_step_with_all_that_was_asked(session: Session, runner: Runner) -> None:
    wish = replace(a_wish(session, title="smooth a little"), also={"why": "noise"})
    patch = Editor(session.document.take).patch(wish.inputs)
    step = runner.keep(wish, patch)
    assert session.document.undo.undoText() == "smooth a little" and runner.last is None
    assert isinstance(step, EditCommand) and step.edit.kind == "smooth"
    assert step.edit.inputs == {"why": "noise", "request": "smooth", **wish.inputs.stored()}
    np.testing.assert_array_equal(session.document.take.weights, patch.apply(session.document.original).weights)


def test_a_sentence_ends_the_wish_and_the_draft(qtbot: QtBot, session: Session, editing: Editing) -> None:
    with qtbot.waitSignal(editing.failed, timeout=10_000) as told:
        editing.run(SmoothRequest((20, 40), 400.0))
    assert "cutoff" in told.args[0] and not editing.busy and session.document.draft is None


def asked_of(session: Session) -> dict[str, Any]:
    return {
        "smooth": SmoothRequest((20, 60), 4.0),
        "clean": CleanRequest((20, 60), 0.5),
        "paste": PasteRequest(70, session.document.take.weights[10:15]),
        "pin": PinRequest({50: {"mouthSmileLeft": 0.8}}, (40, 60)),
        "weight": WeightRequest("jawOpen", 30, np.linspace(0, 1, 20)),
    }


@pytest.mark.parametrize("verb", ["smooth", "clean", "paste", "pin", "weight", "drag"])
def test_a_step_is_done_again_from_what_a_project_keeps_of_it(
    qtbot: QtBot, session: Session, editing: Editing, verb: str
) -> None:
    before = Base.of(session.document)
    if verb == "drag":
        editing.ask(40, session.document.controls[40:60] + 0.5)
    else:
        editing.run(asked_of(session)[verb])
    editing.finish("an edit", kind=verb)
    qtbot.waitUntil(lambda: session.document.undo.count() == 1, timeout=60_000)
    edit = session.document.contents().edits[-1]
    kept = json.loads(json.dumps(dict(edit.inputs)))
    request = restored(kept["request"], kept)
    again = Editor(before.take, before.controls, asked=before.asked).patch(request).settled(before.take)
    np.testing.assert_array_equal(again.weights, edit.weights)
    assert (edit.kind, again.start) == (verb, edit.start)


def test_what_is_too_large_for_a_project_is_not_kept_with_the_step(session: Session) -> None:
    rows = np.zeros((LARGEST_KEPT // len(SHAPES), len(SHAPES)))
    small, large = (
        Asked("paste", PasteRequest(0, each), Base.of(session.document)).stored for each in (rows[:5], rows)
    )
    assert "weights" in small and "weights" not in large and large["start"] == 0
    with pytest.raises(EditError, match="does not say what it was made from"):
        restored("paste", large)


def test_a_second_gesture_waits_until_the_first_is_a_step(qtbot: QtBot, session: Session, editing: Editing) -> None:
    editing.run(SmoothRequest((20, 60), 4.0))
    editing.finish("first", kind="smooth")
    editing.run(SmoothRequest((80, 90), 4.0))  # not taken
    qtbot.waitUntil(lambda: session.document.undo.count() == 1, timeout=60_000)
    assert session.document.undo.undoText() == "first" and not editing.busy
    assert (session.document.take.weights[80:90] == session.document.original.weights[80:90]).all()


def test_a_draft_that_is_there_is_kept_at_once(qtbot: QtBot, session: Session, editing: Editing) -> None:
    assert editing.since == 0.0
    editing.run(SmoothRequest((20, 60), 4.0))
    qtbot.waitUntil(lambda: session.document.draft is not None, timeout=60_000)
    draft = session.document.draft
    assert isinstance(draft, Patch) and editing.since > 0
    editing.finish("smooth", kind="smooth")
    assert session.document.undo.count() == 1
    np.testing.assert_array_equal(session.document.take.weights, draft.apply(session.document.original).weights)
    editing.finish("nothing is under way")
    assert session.document.undo.count() == 1


def test_another_take_ends_what_is_under_way(qtbot: QtBot, session: Session, editing: Editing) -> None:
    editing.run(SmoothRequest((20, 60), 4.0))
    seen: list[Change] = []
    session.changed.connect(seen.append)
    session.open(Take(session.document.take.weights[:70], 30.0), None)
    assert not editing.busy and seen
    editing.finish("too late")
    qtbot.waitUntil(lambda: editing.idle, timeout=60_000)
    assert session.document.undo.count() == 0
