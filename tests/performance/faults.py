"""What a failing computer does to a session that edits, saves and records: python -m tests.performance.faults.

A full disk and one that becomes read-only (a small tmpfs; needs root), a program suspended for ten seconds, a clock
that is set back by years. Each prints what was reported as safe and what was found; nothing that was may be missing.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from app.session.left_over import unsaved_work
from engine.errors import EngineError
from engine.formats import write_take
from engine.project import Contents, Edit, InUseError, Project, create
from engine.take import SHAPES, Take
from tests.performance import kills, sessions

SUSPENDED_S = 10.0
DISK = "6m"
FRAMES = 2000


@contextmanager
def small_disk(folder: Path) -> Iterator[Path]:
    """Mount a disk of a few megabytes."""
    folder.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK}", "retake-test", str(folder)], check=True)
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", str(folder)], check=True)


def edited(project: Project, rng: np.random.Generator) -> Contents:
    """Return a project's contents with one edit more, of noise, which does not compress."""
    before = project.contents
    rows = rng.random((200, len(SHAPES))), np.full((200, 8), np.nan)
    edits = (*before.edits, Edit("drag", f"edit {len(before.edits)}", 5, *rows))
    return Contents(before.original, edits, len(edits))


def fill_up(folder: Path, rng: np.random.Generator) -> str:
    """Edit and save until the disk is full, then when there is room again; returns what came of it."""
    path, safe, refusals = folder / "a.retake", 0, 0
    project = create(path, Contents(Take(weights=rng.random((FRAMES, len(SHAPES))), fps=60.0, name="full")))
    (folder / "other").write_bytes(bytes(2_000_000))
    while refusals < 3:
        try:
            project.put(edited(project, rng))
            safe = len(project.contents.edits)
        except EngineError:
            refusals += 1
    copy = folder.parent / "full.retake"
    shutil.copyfile(path, copy)  # what is on the disk, of the file alone
    found = len(Project.open(copy, read_only=True).contents.edits)
    assert found == safe, (found, safe)
    assert refused(lambda: create(folder / "b.retake", project.contents))
    assert refused(lambda: write_take(project.contents.original, folder / "out.csv"))
    assert not list(folder.glob(".*.part"))
    (folder / "other").unlink()
    project.put(edited(project, rng))
    project.close()
    again = len(Project.open(path).contents.edits)
    assert again == safe + 1
    return f"{safe} steps safe, {refusals} refused with a sentence, {found} found; {again} when there was room again"


def read_only(folder: Path, rng: np.random.Generator) -> str:
    """Open a project on a disk that cannot be written, and try to write there; returns what came of it."""
    path = folder / "a.retake"
    create(path, Contents(Take(weights=rng.random((FRAMES, len(SHAPES))), fps=60.0, name="kept"))).close()
    before = path.read_bytes()
    subprocess.run(["mount", "-o", "remount,ro", str(folder)], check=True)
    opened = Project.open(path)
    assert opened.read_only
    tries = [
        lambda: opened.put(edited(opened, rng)),
        lambda: create(path, opened.contents),
        lambda: create(folder / "b.retake", opened.contents),
        lambda: write_take(opened.contents.original, folder / "out.csv"),
    ]
    told = [refused(each) for each in tries]
    assert all(told) and path.read_bytes() == before and [entry.name for entry in folder.iterdir()] == ["a.retake"]
    return f"opened to read, {len(told)} ways to write refused with a sentence: {told[0]}"


def refused(write: Callable[[], object]) -> str:
    """Return the sentence by which something is refused, empty where it is not."""
    try:
        write()
    except EngineError as error:
        return error.sentence
    return ""


def suspended(folder: Path, kind: str) -> str:
    """Suspend a session for ten seconds while others look at what it has, let it go on, and kill it."""
    process, told = kills.start(kills.SESSIONS[kind], folder, 7)
    try:
        messages = kills.listen(told, 2.0)
        assert messages and process.pid is not None
        os.kill(process.pid, signal.SIGSTOP)
        looks = 0
        until = time.monotonic() + SUSPENDED_S
        while time.monotonic() < until:
            assert [left.path for left in unsaved_work(folder) if _is_open(left.path)] == []
            looks += 1
            time.sleep(1.0)
        for path in folder.rglob("*"):
            if path.is_file():
                os.utime(path, (1.0, 1.0))  # a clock that was set back, or forth: no age says anything
        unsaved_work(folder)
        os.kill(process.pid, signal.SIGCONT)
        went_on = kills.listen(told, 2.0)
        assert any(text[0] == "kept" for text in went_on), "it did not go on"
        messages += went_on + kills.kill(process, told)
    finally:
        process.kill()
    found = sessions.next_start(folder, kills.content_of)
    if kind == "record":
        reports = sessions.recorded(folder, messages)
    else:
        allowed, reports = kills.may_be_found([each for each in messages if each[0] != "saved"])
        assert any(content in allowed for content in found)
    return f"{looks} looks by another program, {reports} reports, none lost"


def _is_open(path: Path) -> bool:
    try:
        Project.open(path).close()
    except InUseError:
        return True
    return False


def main() -> None:
    """Try each fault once."""
    for name, fault in (("full", fill_up), ("read-only", read_only)):
        with tempfile.TemporaryDirectory() as folder, small_disk(Path(folder) / "disk") as disk:
            print(f"{name}: {fault(disk, np.random.default_rng(1))}", flush=True)
    for kind in ("edit", "replace", "record"):
        with tempfile.TemporaryDirectory() as folder:
            print(f"suspended, clock set back ({kind}): {suspended(Path(folder), kind)}", flush=True)


if __name__ == "__main__":
    from tests.performance.faults import main  # under its own name, as the sessions' processes know it

    sys.exit(main())
