from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.session import Session
from app.session.opening import InUse, Opened, Opening, Wish, opened
from engine import project
from engine.errors import EngineError
from engine.extended import bundled_face
from engine.formats import read_take
from engine.lab.performer import demo
from engine.project import Contents, Edit, Project
from engine.take import SHAPES, Take


@pytest.fixture
def session(qtbot: QtBot, random_take: Take) -> Session:
    return Session(random_take)


@pytest.fixture
def opening(session: Session) -> Iterator[Opening]:
    reading = Opening(session)
    yield reading
    reading.close()


@pytest.fixture
def path(random_take: Take, tmp_path: Path) -> Path:
    rows = np.full((2, len(SHAPES)), 0.5), np.full((2, 16), np.nan)
    edits = (Edit("paste", "first", 3, *rows, {}), Edit("paste", "second", 9, *rows, {}))
    project.create(tmp_path / "a.retake", Contents(random_take, edits, 1)).close()
    return tmp_path / "a.retake"


def test_a_take_comes_with_its_controls_measured_once(session: Session) -> None:
    shares: list[float] = []
    found = opened(session, Wish(demo.BUNDLED), shares.append)
    take = read_take(demo.BUNDLED)
    np.testing.assert_array_equal(found.take.weights, take.weights)
    np.testing.assert_array_equal(found.measured[0], bundled_face().measure(take.weights))
    assert found.measured[0] is found.measured[1] and not found.measured[0].flags.writeable
    assert found.project is None and found.state is None and found.steps == () and found.path == demo.BUNDLED
    assert shares[0] == 0.0 and shares == sorted(shares)


def test_a_project_comes_with_its_steps_and_what_they_come_to(session: Session, path: Path, random_take: Take) -> None:
    shares: list[float] = []
    found = opened(session, Wish(path), shares.append)
    assert found.project is not None and found.state is not None
    try:
        assert [step.text() for step in found.steps] == ["first", "second"]
        np.testing.assert_array_equal(found.take.weights, random_take.weights)
        np.testing.assert_array_equal(found.measured[0], bundled_face().measure(random_take.weights))
        np.testing.assert_array_equal(found.measured[1], bundled_face().measure(found.state.take.weights))
        assert (found.state.take.weights[3:5] == 0.5).all() and (found.state.take.weights[9:11] != 0.5).all()
        assert shares[-1] == 1.0
    finally:
        found.drop()
    Project.open(path).close()  # what is dropped is let go of


def test_a_project_is_let_go_of_where_reading_it_ends_early(session: Session, path: Path) -> None:
    def stop(_: float) -> None:
        raise EngineError("This is not wanted any more.")

    with pytest.raises(EngineError):
        opened(session, Wish(path), stop)

    def stop_later(share: float) -> None:
        if share == 1.0:
            stop(share)

    with pytest.raises(EngineError):
        opened(session, Wish(path), stop_later)
    Project.open(path).close()


def test_unsaved_work_is_a_project_whatever_its_name(session: Session, path: Path) -> None:
    other = path.rename(path.with_suffix(".work"))
    found = opened(session, Wish(other, left_over=True))
    assert found.project is not None
    found.drop()


def test_a_file_is_read_beside_the_window(qtbot: QtBot, opening: Opening, path: Path) -> None:
    with qtbot.waitSignal(opening.done, timeout=30_000) as told:
        opening.read(path)
        assert opening.path == path
    (found,) = told.args
    assert isinstance(found, Opened) and found.wish.path == path and opening.path is None
    found.drop()


def test_a_newer_wish_ends_the_older(qtbot: QtBot, opening: Opening, path: Path) -> None:
    arrived: list[Opened] = []
    opening.done.connect(arrived.append)
    opening.read(path)
    opening.read(demo.BUNDLED)
    qtbot.waitUntil(lambda: len(arrived) == 1 and opening._work.idle, timeout=30_000)
    assert arrived[0].path == demo.BUNDLED
    Project.open(path).close()


def test_a_project_that_another_program_has_open_is_told_and_can_be_read_alone(
    qtbot: QtBot, opening: Opening, path: Path
) -> None:
    held = Project.open(path)
    try:
        with qtbot.waitSignal(opening.in_use, timeout=30_000) as told:
            opening.read(path)
        assert told.args[0] == path and told.args[1] and opening.path is None
        with qtbot.waitSignal(opening.done, timeout=30_000) as read:
            opening.read(path, read_only=True)
        read.args[0].drop()
    finally:
        held.close()
    InUse("").drop()


def test_what_cannot_be_read_is_told_and_nothing_more_once_it_is_not_wanted(
    qtbot: QtBot, opening: Opening, tmp_path: Path
) -> None:
    with qtbot.waitSignal(opening.failed, timeout=30_000) as told:
        opening.read(tmp_path / "none.csv")
    assert told.args[0].endswith(".") and opening.path is None
    failures: list[str] = []
    opening.failed.connect(lambda sentence, advice: failures.append(sentence))
    with qtbot.waitSignal(opening._work.failed, timeout=30_000):  # after what the opening makes of it
        opening.read(tmp_path / "none.csv")
        opening.stop()
    assert failures == [] and opening.path is None
