from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtGui import QUndoCommand
from pytestqt.qtbot import QtBot

from app.session import Session
from app.session.commands import EditCommand, MarkCommand
from app.session.keeper import Keeper
from app.session.opening import Wish, opened
from engine import project
from engine.editing import Patch
from engine.errors import EngineError
from engine.extended import bundled_face
from engine.project import Marks, Note, Pin, Project, Span, Verdict
from engine.take import SHAPES, Take
from tests.performance import kills

Made = Callable[..., Keeper]

measure = bundled_face().measure


@pytest.fixture
def make(random_take: Take, tmp_path: Path) -> Iterator[Made]:
    """Make keepers with a session each, all with the same folder; they are closed at the end."""
    made = []

    def start(take: Take = random_take, folder: Path = tmp_path / "data" / "unsaved") -> Keeper:
        made.append(Keeper(Session(take), folder))
        return made[-1]

    yield start
    for keeper in made:
        if keeper._work._thread.isRunning():
            keeper.close()


def push(session: Session, seed: int) -> EditCommand:
    rng = np.random.default_rng(seed)
    start = int(rng.integers(0, 20))
    weights = rng.random((12, len(SHAPES)))
    reached = measure(weights)
    asked = np.where(rng.random(reached.shape) < 0.3, reached + 1.0, session.document.controls[start : start + 12])
    patch = Patch(start, weights, asked, reached)
    command = EditCommand.of(session.document, patch, f"edit {seed}", inputs={"seed": seed})
    session.document.undo.push(command)
    return command


def kept(qtbot: QtBot, keeper: Keeper, change: Callable[[], object]) -> None:
    """Change something and wait until exactly that is safe on disk."""
    with qtbot.waitSignal(keeper.kept, timeout=10_000):
        change()
    qtbot.waitUntil(lambda: keeper._work.idle, timeout=10_000)
    with keeper._lock:
        stored, now = keeper._project.contents, keeper._session.document.contents()
    assert (stored.edits, stored.position, stored.marks) == (now.edits, now.position, now.marks)


def saved(qtbot: QtBot, keeper: Keeper, path: Path) -> None:
    with qtbot.waitSignal(keeper.saved, timeout=10_000) as told:
        keeper.save_as(path)
    assert told.args == [path] and keeper.saving is None


def refused(qtbot: QtBot, keeper: Keeper, path: Path) -> str:
    with qtbot.waitSignal(keeper.failed, timeout=10_000) as told:
        keeper.save_as(path)
    assert keeper.saving is None and told.args[1]
    return str(told.args[0])


def alike(left: Session, right: Session) -> bool:
    for name in ("weights", "lost", "rotations"):
        np.testing.assert_array_equal(getattr(left.document.take, name), getattr(right.document.take, name))
        np.testing.assert_array_equal(getattr(left.document.original, name), getattr(right.document.original, name))
    np.testing.assert_allclose(left.document.controls, right.document.controls, atol=1e-9)
    np.testing.assert_array_equal(left.document.asked, right.document.asked)
    titles = [
        [stack.text(index) for index in range(stack.count())] for stack in (left.document.undo, right.document.undo)
    ]
    assert titles[0] == titles[1]
    assert (left.document.undo.index(), left.document.marks) == (right.document.undo.index(), right.document.marks)
    return True


def test_nothing_is_written_before_the_first_edit(qtbot: QtBot, make: Made, tmp_path: Path) -> None:
    first = make()
    kept(qtbot, first, lambda: push(first._session, 1))
    first.forget()
    lost = np.arange(9) < 3
    first._session.open(Take(weights=np.zeros((9, len(SHAPES))), fps=24.0, lost=lost), None)
    first.close()
    assert list((tmp_path / "data" / "unsaved").iterdir()) == []


def test_work_that_was_left_comes_back_with_its_undo_history(qtbot: QtBot, make: Made) -> None:
    first, second = make(), make()
    session = first._session
    for seed in range(4):
        kept(qtbot, first, lambda seed=seed: push(session, seed))
    kept(qtbot, first, session.document.undo.undo)
    kept(qtbot, first, session.document.undo.undo)
    kept(qtbot, first, session.document.undo.redo)
    marked = Marks(spans=(Span(2, 9),), pins=(Pin(4, {"jawOpen": 0.5}, 0, 9),))
    kept(qtbot, first, lambda: session.document.undo.push(MarkCommand.of(session.document, marked, "mark a span")))
    noted = replace(marked, notes=(Note(3, "Ana", "2025-01-02T03:04:05Z", "here"),))
    kept(qtbot, first, lambda: session.document.set_marks(noted))
    judged = replace(noted, verdicts=(Verdict("Approved"),))
    kept(qtbot, first, lambda: session.document.undo.push(MarkCommand.of(session.document, judged, "approve")))
    assert second.left_over() == []  # its program still runs
    first.close()

    (left,) = second.left_over()
    assert (left.name, left.edits) == ("random", 5)
    assert left.sentence.startswith("random (00:00:01:10), 5 edits, ")
    second.open(opened(second._session, Wish(left.path, left_over=True)))
    again = second._session
    assert alike(session, again) and again.document.edited and again.document.path is None
    while session.document.undo.canRedo():
        session.document.undo.redo()
        again.document.undo.redo()
    while session.document.undo.canUndo():
        assert alike(session, again)
        session.document.undo.undo()
        again.document.undo.undo()
    np.testing.assert_array_equal(again.document.take.weights, again.document.original.weights)
    assert again.document.marks == Marks()
    kept(qtbot, second, lambda: push(again, 9))  # it goes on where it was
    second.close()
    (left,) = make().left_over()
    assert left.edits == 1


class Nudge(EditCommand):
    """An edit that takes in the one after it, as typing a value twice does."""

    def id(self) -> int:
        return 7

    def mergeWith(self, other: QUndoCommand) -> bool:
        self.edit, self._after = other.edit, other._after
        return True


def test_a_step_that_was_merged_is_kept_as_it_became(qtbot: QtBot, make: Made) -> None:
    first, second = make(), make()
    session = first._session
    for value in (0.25, 0.5):
        rows = np.full((5, len(SHAPES)), value)
        patch = Patch(2, rows, measure(rows), measure(rows))
        kept(qtbot, first, lambda patch=patch: session.document.undo.push(Nudge.of(session.document, patch, "nudge")))
    assert session.document.undo.count() == 1
    first.close()
    second.open(opened(second._session, Wish(second.left_over()[0].path, left_over=True)))
    assert alike(session, second._session)


def test_saving_moves_the_work_to_the_project_and_every_later_step_too(
    qtbot: QtBot, make: Made, tmp_path: Path
) -> None:
    first, path = make(), tmp_path / "Ärger 顔.retake"
    session = first._session
    kept(qtbot, first, lambda: push(session, 1))
    assert session.document.edited
    saved(qtbot, first, path)
    assert (first.path, session.document.path, session.document.edited) == (path, path, False)
    assert first.left_over() == [] and list((tmp_path / "data" / "unsaved").glob("*.retake")) == []
    kept(qtbot, first, lambda: push(session, 2))
    assert not session.document.edited  # it is safe in the user's own file
    first.close()

    second = make()
    second.open(opened(second._session, Wish(path)))
    assert alike(session, second._session) and not second._session.document.edited and second.path == path
    assert second.left_over() == []


def test_saving_before_any_edit_and_over_an_older_project(qtbot: QtBot, make: Made, tmp_path: Path) -> None:
    first, second, path = make(), make(), tmp_path / "a.retake"
    saved(qtbot, first, path)
    push(second._session, 1)
    assert refused(qtbot, second, path) == "a.retake is open in another Retake."
    assert second._session.document.edited and second.path is None
    first.close()
    saved(qtbot, second, path)
    saved(qtbot, second, path)
    second.close()
    assert len(Project.open(path).contents.edits) == 1


def test_discarded_work_is_gone(qtbot: QtBot, make: Made) -> None:
    first = make()
    kept(qtbot, first, lambda: push(first._session, 1))
    first.forget()
    first.close()
    second, third = make(), make()
    assert second.left_over() == []
    kept(qtbot, second, lambda: push(second._session, 1))
    second.close()
    third.discard(third.left_over()[0])
    assert third.left_over() == []


def test_opening_another_take_neither_loses_nor_empties_what_was_kept(
    qtbot: QtBot, make: Made, random_take: Take, tmp_path: Path
) -> None:
    first = make()
    kept(qtbot, first, lambda: push(first._session, 1))
    first._session.open(Take(weights=np.zeros((9, len(SHAPES))), fps=24.0), None)
    (left,) = first.left_over()
    first.open(opened(first._session, Wish(left.path, left_over=True)))
    saved(qtbot, first, tmp_path / "a.retake")
    first._session.open(first._session.document.original, None)  # the very same take again
    push(first._session, 2)
    first.close()
    assert len(Project.open(tmp_path / "a.retake").contents.edits) == 1
    assert len(make().left_over()) == 1


def test_a_project_that_cannot_be_read_leaves_the_session_as_it_was(qtbot: QtBot, make: Made, tmp_path: Path) -> None:
    first = make()
    kept(qtbot, first, lambda: push(first._session, 1))
    take = first._session.document.take
    (tmp_path / "a.retake").write_bytes(b"nonsense" * 500)
    with pytest.raises(EngineError, match="not a Retake project"):
        first.open(opened(first._session, Wish(tmp_path / "a.retake")))
    assert first._session.document.take is take
    kept(qtbot, first, lambda: push(first._session, 2))


def test_a_folder_that_cannot_be_written_is_reported_once_and_tried_again_with_each_edit(
    qtbot: QtBot, make: Made, tmp_path: Path
) -> None:
    (tmp_path / "data").write_bytes(b"a file where the folder should be")
    first, second = make(), make()
    told: list[tuple[str, str]] = []
    first.failed.connect(lambda *sentence: told.append(sentence))
    with qtbot.waitSignal(first.failed, timeout=10_000):
        push(first._session, 0)
    for seed in (1, 2):
        with qtbot.waitSignal(first._work.failed, timeout=10_000):
            push(first._session, seed)
    assert len(told) == 1 and told[0][0].startswith("Unsaved work cannot be kept in ") and told[0][1]
    (tmp_path / "data").unlink()
    kept(qtbot, first, lambda: push(first._session, 3))
    first.close()
    second.open(opened(second._session, Wish(second.left_over()[0].path, left_over=True)))
    assert alike(first._session, second._session) and second._session.document.undo.count() == 4


def test_a_full_disk_keeps_the_work_in_memory_until_there_is_room(qtbot: QtBot, make: Made, tmp_path: Path) -> None:
    first = make()
    push(first._session, 0)
    saved(qtbot, first, tmp_path / "a.retake")
    database = first._project._database
    database.execute(f"PRAGMA max_page_count = {database.execute('PRAGMA page_count').fetchone()[0]}")
    with qtbot.waitSignal(first.failed, timeout=10_000) as told:
        push(first._session, 1)
    assert told.args[0] == "There is no room left on the disk for a.retake." and "memory" in told.args[1]
    assert first._session.document.edited and first._session.document.undo.count() == 2
    assert "no room left" in refused(qtbot, first, tmp_path / "a.retake")
    database.execute("PRAGMA max_page_count = 1000000")
    with qtbot.waitSignal(first.mended, timeout=10_000) as over:
        kept(qtbot, first, lambda: push(first._session, 2))
    assert over.args == ["There is no room left on the disk for a.retake."]
    assert not first._session.document.edited
    (tmp_path / "a.retake").unlink()
    push(first._session, 3)
    saved(qtbot, first, tmp_path / "a.retake")
    first.close()
    assert len(Project.open(tmp_path / "a.retake").contents.edits) == 4


def test_no_room_for_unsaved_work_is_reported_without_the_name_of_its_file(
    qtbot: QtBot, make: Made, tmp_path: Path
) -> None:
    first = make()
    kept(qtbot, first, lambda: push(first._session, 0))
    database = first._project._database
    database.execute(f"PRAGMA max_page_count = {database.execute('PRAGMA page_count').fetchone()[0]}")
    with qtbot.waitSignal(first.failed, timeout=10_000) as told:
        push(first._session, 1)
    assert told.args[0] == "There is no room left on the disk for unsaved work."


def test_what_cannot_be_written_is_edited_as_unsaved_work(
    qtbot: QtBot, make: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, path = make(), tmp_path / "a.retake"
    push(first._session, 0)
    saved(qtbot, first, path)
    first.close()
    second, before = make(), path.read_bytes()
    monkeypatch.setattr("engine.project.store.os.access", lambda *_: False)
    second.open(opened(second._session, Wish(path)))
    assert second.path is None and second._session.document.path == path
    kept(qtbot, second, lambda: push(second._session, 1))
    second.close()
    assert path.read_bytes() == before
    assert make().left_over()[0].edits == 2


def test_a_whole_take_edit_returns_to_the_user_at_once(qtbot: QtBot, make: Made) -> None:
    first = make()
    locked = first._lock.acquire()
    assert locked  # a disk that takes for ever
    push(first._session, 0)
    push(first._session, 1)
    first._lock.release()
    qtbot.waitSignal(first.kept, timeout=10_000).wait()
    kept(qtbot, first, lambda: push(first._session, 2))
    assert len(first._project.contents.edits) == 3


def test_a_running_program_keeps_its_work_to_itself(make: Made, tmp_path: Path) -> None:
    process, told = kills.start(kills.edit_until_killed, tmp_path, 1)
    try:
        while told.recv()[0] != "kept":
            pass
        watcher = make(folder=tmp_path)
        assert watcher.left_over() == []
        (path,) = tmp_path.glob("*.retake")
        with pytest.raises(project.InUseError):
            project.delete(path)
    finally:
        process.kill()
        process.join()
    assert len(watcher.left_over()) == 1


@pytest.mark.parametrize("seed", range(10))
def test_a_kill_loses_no_edit_that_was_reported_as_finished(seed: int, tmp_path: Path) -> None:
    kills.check(seed, tmp_path, "edit")


@pytest.mark.parametrize("seed", range(5))
def test_a_kill_while_saving_never_harms_the_old_file(seed: int, tmp_path: Path) -> None:
    kills.check(seed, tmp_path, "save")


def test_the_session_s_contents_are_what_its_edits_come_to(make: Made) -> None:
    session = make()._session
    for seed in range(5):
        push(session, seed)
    session.document.undo.undo()
    state = project.replay(session.document.contents())
    np.testing.assert_array_equal(state.take.weights, session.document.take.weights)
    np.testing.assert_array_equal(state.asked, session.document.asked)
    session.document.set_marks(replace(session.document.marks, verdicts=(Verdict("Approved"),)))
    assert session.document.contents().marks.verdict == "Approved"
