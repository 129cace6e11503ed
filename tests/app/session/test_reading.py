"""Another reading of the open take: a step like any other, to the bit, kept in the project with the edits around it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.session import Session
from app.session.commands import EditCommand, ReadingCommand, restored
from engine import project
from engine.editing import Patch
from engine.extended import bundled_face
from engine.formats import livelink, read_take, write_take
from engine.formats.base.reading import ReadAs, Reading
from engine.formats.livelink.sides import exchange
from engine.project import Contents, Project, replay
from engine.take import SHAPES, Take


@pytest.fixture
def take(tmp_path: Path) -> Take:
    rng = np.random.default_rng(1)
    write_take(Take(rng.random((80, len(SHAPES))), 30.0), tmp_path / "given.csv")
    return read_take(tmp_path / "given.csv")


def edit(session: Session, seed: int) -> None:
    rng = np.random.default_rng(seed)
    start = int(rng.integers(0, 60))
    rows = rng.random((12, len(SHAPES)))
    made = session.document.take.with_rows(start, rows)
    patch = Patch.between(session.document.take, made, (start, start + 12))
    session.document.undo.push(EditCommand.of(session.document, patch, f"edit {seed}"))


def read(session: Session, fps: float, *, swapped: bool) -> None:
    chosen = Reading(fps, "recorded" if swapped else "named")
    session.document.undo.push(ReadingCommand.of(session.document, ReadAs(chosen, fps, swapped), "read"))


def state(session: Session) -> tuple[object, ...]:
    """What is open, to the bit; its curves, measured by rows or as a whole, are its own within rounding."""
    measure = bundled_face().measure
    np.testing.assert_allclose(session.document.controls, measure(session.document.take.weights), atol=1e-9)
    np.testing.assert_allclose(
        session.document.original_controls, measure(session.document.original.weights), atol=1e-9
    )
    return (
        session.document.take.fps,
        session.document.take.weights.tobytes(),
        session.document.original.weights.tobytes(),
        session.document.reading,
        livelink.read_as(session.document.take).swapped,
    )


def test_each_step_is_undone_and_done_again_to_the_bit(take: Take) -> None:
    session, states = Session(take), []
    steps = [
        lambda: edit(session, 1),
        lambda: read(session, 60.0, swapped=False),
        lambda: edit(session, 2),
        lambda: read(session, 25.0, swapped=False),
        lambda: read(session, 30.0, swapped=True),
        lambda: edit(session, 3),
    ]
    states.append(state(session))
    for step in steps:
        step()
        states.append(state(session))
    assert len(set(states)) == len(states)
    for wanted in reversed(states[:-1]):
        session.document.undo.undo()
        assert state(session) == wanted
    for wanted in states[1:]:
        session.document.undo.redo()
        assert state(session) == wanted


def test_edits_of_before_go_along(take: Take) -> None:
    session = Session(take)
    edit(session, 1)
    before = session.document.take.weights
    read(session, 60.0, swapped=False)
    np.testing.assert_array_equal(session.document.take.weights, exchange(before))
    np.testing.assert_array_equal(session.document.original.weights, exchange(take.weights))
    assert session.document.take.fps == session.document.original.fps == 60.0


@pytest.mark.parametrize("position", range(6))
def test_a_project_remembers_how_it_was_read(take: Take, tmp_path: Path, position: int) -> None:
    session = Session(take)
    edit(session, 1)
    read(session, 60.0, swapped=False)
    edit(session, 2)
    read(session, 30.0, swapped=True)
    edit(session, 3)
    session.document.undo.setIndex(position)
    project.create(tmp_path / "a.retake", session.document.contents()).close()
    opened = Project.open(tmp_path / "a.retake")
    contents = opened.contents
    opened.close()
    came = replay(contents)
    assert came.original is not None
    again = Session(take)
    measured = tuple(Session(each).document.controls for each in (came.original, came.take))
    again.restore(contents, None, tuple(restored(again.document, contents, came)), came, measured)
    assert state(again) == state(session)
    exported = read_take(tmp_path / "a.retake")
    np.testing.assert_array_equal(exported.weights, session.document.take.weights)
    assert exported.fps == session.document.take.fps
    for index in (0, 5, 3, 1, 4, 2):
        session.document.undo.setIndex(index)
        again.document.undo.setIndex(index)
        assert state(again) == state(session)


@pytest.mark.parametrize("fps", [None, 25.0])
@pytest.mark.parametrize("sides", ["automatic", "recorded", "named"])
def test_a_command_may_read_a_project_otherwise(take: Take, tmp_path: Path, fps: float | None, sides: str) -> None:
    session = Session(take)
    edit(session, 1)
    read(session, 60.0, swapped=False)
    project.create(tmp_path / "a.retake", session.document.contents()).close()
    found = read_take(tmp_path / "a.retake", reading=Reading(fps, sides))
    assert found.fps == (fps or 60.0)
    expected = exchange(session.document.take.weights) if sides == "recorded" else session.document.take.weights
    np.testing.assert_array_equal(found.weights, expected)


def test_untouched_rows_are_exported_as_they_came_whatever_the_reading(take: Take, tmp_path: Path) -> None:
    session = Session(take)
    read(session, 60.0, swapped=False)
    write_take(session.document.take, tmp_path / "out.csv")
    assert (tmp_path / "out.csv").read_bytes() == (tmp_path / "given.csv").read_bytes()


def test_a_take_of_no_file_has_a_rate_to_choose_and_no_sides(take: Take) -> None:
    bare = Take(take.weights, 30.0)
    session = Session(bare)
    read(session, 24.0, swapped=True)
    assert session.document.take.fps == 24.0
    np.testing.assert_array_equal(session.document.take.weights, bare.weights)
    assert isinstance(session.document.contents(), Contents) and session.document.contents().original is bare
