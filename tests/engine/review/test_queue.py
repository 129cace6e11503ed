"""A folder of pairs: what was judged stays judged, and a take that changed is judged again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from engine import project
from engine.errors import EngineError
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.project import Note, Project, Verdict, replay
from engine.review.queue import CHANGED, FOLDER, Entry, begun, entries, looked_up, next_open, progress
from engine.take import SHAPE_INDEX

DEMO = read_take(demo.BUNDLED)


def version(path: Path, amount: float, frames: int = 120) -> Path:
    weights = DEMO.weights[:frames].copy()
    weights[40:60, SHAPE_INDEX["jawOpen"]] += amount
    path.parent.mkdir(parents=True, exist_ok=True)
    write_take(type(DEMO)(weights, DEMO.fps, name=path.name), path)
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for number in range(3):
        version(tmp_path / "before" / f"shot{number}.csv", 0.0)
        version(tmp_path / "after" / f"shot{number}.csv", 0.1 * (number + 1))
    return tmp_path


def judge(entry: Entry, *verdicts: Verdict, notes: tuple[Note, ...] = ()) -> None:
    opened = Project.open(begun(entry))
    marks = replace(opened.contents.marks, verdicts=verdicts, notes=notes)
    opened.put(replace(opened.contents, marks=marks))
    opened.close()


def test_what_is_judged_is_found_again_and_counted(folder: Path) -> None:
    queue = entries(folder)
    assert progress(queue) == "0 of 3 judged" and next_open(queue) == 0
    assert not (folder / FOLDER).exists()  # looking writes nothing
    judge(queue[0], Verdict("Approved", "", "Ana", "2025-01-02T03:04:05Z"))
    judge(queue[1], Verdict("Needs work"), Verdict("", "", "Ana"))
    queue = entries(folder)
    assert progress(queue) == "1 of 3 judged" and next_open(queue) == 1
    assert queue[0].verdict == Verdict("Approved", "", "Ana", "2025-01-02T03:04:05Z") and queue[1].verdict is None


def test_a_review_holds_both_takes_and_is_not_made_anew(folder: Path) -> None:
    (entry, *_) = entries(folder)
    path = begun(entry)
    state = replay(Project.open(path, read_only=True).contents)
    assert state.original is not None and (state.take.weights != state.original.weights).any(axis=1).sum() == 20
    before = path.read_bytes()
    assert begun(entry) == path and path.read_bytes() == before


def test_a_take_that_was_changed_is_shown_as_it_is_now_and_judged_again(folder: Path) -> None:
    entry = entries(folder)[0]
    judge(entry, Verdict("Needs work", "the jaw"), notes=(Note(50, "Ana", "", "here"), Note(110, "Ana", "", "b", 10)))
    version(entry.after, 0.0, frames=115)
    contents = Project.open(begun(entry), read_only=True).contents
    assert len(contents.original) == 115
    assert [(note.frame, note.stop) for note in contents.marks.notes] == [(50, 51), (110, 115)]
    assert [verdict.judgement for verdict in contents.marks.verdicts] == ["Needs work", ""]
    assert contents.marks.verdicts[-1].why == CHANGED
    assert not looked_up(entry).judged


def test_what_is_open_or_damaged_or_not_there_is_a_sentence(folder: Path) -> None:
    queue = entries(folder)
    held = Project.open(begun(queue[0]))
    begun(queue[1]).write_bytes(b"SQLite format 3\x00 broken")
    found = entries(folder)
    assert "open in another" in found[0].trouble and found[1].trouble and not found[2].trouble
    held.close()
    with pytest.raises(EngineError):
        entries(folder / "nowhere")
    queue[2].after.write_text("x")
    with pytest.raises(EngineError):
        begun(queue[2])
    assert not queue[2].review.exists()


def test_looking_at_a_verdict_reads_no_take(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    judge(entries(folder)[0], Verdict("Approved"))
    monkeypatch.setattr(project.store.rows, "read_contents", lambda *_: pytest.fail("the whole project was read"))
    assert entries(folder)[0].judged
