"""Kills scripted sessions at random moments and opens what they left: python -m tests.performance.kills 200 [KIND ...]."""

from __future__ import annotations

import hashlib
import multiprocessing
import sys
import tempfile
import time
from collections import Counter
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.project import Contents, Edit, Project, create, replay
from engine.take import SHAPES, Take
from tests.performance import sessions

if TYPE_CHECKING:
    from PySide6.QtCore import QCoreApplication

    from app.session import Session

LONGEST_S = 0.4  # of a session's life
LATEST = 20  # edits after which a session begins to undo more than it does
FRAMES = 2000
SAVED_FRAMES = 8_000  # long enough for a save to take a while
SAVES = 4  # that a session may come to


def fingerprint(contents: Contents) -> str:
    """Return a text that two projects share only where every edit, undone ones too, is the same."""
    state = replay(contents)
    digest = hashlib.sha256(f"{contents.position} {len(contents.edits)} {contents.marks}".encode())
    for array in (state.take.weights, state.asked, *(edit.weights for edit in contents.edits)):
        digest.update(array.tobytes())
    return digest.hexdigest()


def edit_until_killed(folder: Path, seed: int, tell: Connection, *, frames: int = FRAMES, saves: bool = False) -> None:
    """Push, undo and redo edits for ever, telling each state before it is reached and when it is reported safe."""
    from PySide6.QtCore import QCoreApplication

    from app.session import Session
    from app.session.keeper import Keeper

    application = QCoreApplication([])
    rng = np.random.default_rng(seed)
    session = Session(Take(weights=rng.random((frames, len(SHAPES))), fps=60.0, name="killed"))
    keeper = Keeper(session, folder)
    keeper.kept.connect(lambda contents: tell.send(("kept", fingerprint(contents))))
    keeper.failed.connect(lambda *sentence: tell.send(("failed", " ".join(sentence))))
    tell.send(("doing", fingerprint(session.document.contents())))
    while True:
        now = session.document.contents()
        if saves and keeper.saving is None and rng.random() < 0.2:
            (folder / "saved").mkdir(exist_ok=True)
            keeper.save_as(folder / "saved" / f"{rng.integers(0, 2)}.retake")
        if session.document.undo.count() and rng.random() < (0.3 if session.document.undo.index() < LATEST else 0.9):
            position = int(rng.integers(0, session.document.undo.count() + 1))
            tell.send(("doing", fingerprint(replace(now, position=position))))
            session.document.undo.setIndex(position)
        else:
            push(session, rng, tell)
        wait(application, rng)


def push(session: Session, rng: np.random.Generator, tell: Connection) -> None:
    """Make one edit, telling first which state it leads to."""
    from app.session.commands import EditCommand

    now = session.document.contents()
    start, length = int(rng.integers(0, FRAMES - 200)), int(rng.integers(1, 200))
    weights, asked = rng.random((length, len(SHAPES))), rng.random((length, len(ALL_CONTROLS)))
    lost = np.zeros(length, bool)
    patch = SimpleNamespace(  # a Patch would load torch, hundreds of times
        start=start, stop=start + length, weights=weights, asked=asked, reached=asked, granted=None, lost=lost
    )
    patch.settled = lambda _: patch
    command = EditCommand.of(session.document, patch, f"edit {session.document.undo.count()}")
    edits = (*now.edits[: now.position], command.edit)
    tell.send(("doing", fingerprint(replace(now, edits=edits, position=len(edits)))))
    session.document.undo.push(command)


def wait(application: QCoreApplication, rng: np.random.Generator) -> None:
    """Let the session work for a moment."""
    until = time.perf_counter() + rng.exponential(0.01)
    while time.perf_counter() < until:
        application.processEvents()


def edit_and_save_until_killed(folder: Path, seed: int, tell: Connection) -> None:
    """Edit a take that is long enough for a save to take a while, and let it be saved here and there meanwhile."""
    edit_until_killed(folder, seed, tell, frames=SAVED_FRAMES, saves=True)


def save_until_killed(folder: Path, seed: int, tell: Connection) -> None:
    """Edit a project and save copies over one and the same file for ever."""
    rng = np.random.default_rng(seed)
    contents = Contents(Take(weights=rng.random((SAVED_FRAMES, len(SHAPES))), fps=60.0, name="killed"))
    target = folder / "saved.retake"
    create(target, contents).close()
    tell.send(("doing", fingerprint(contents)))
    tell.send(("kept", fingerprint(contents)))
    project = create(folder / "work.retake", contents)
    while True:
        rows = rng.random((60, len(SHAPES))), np.full((60, len(ALL_CONTROLS)), np.nan)
        edits = (*contents.edits, Edit("drag", "an edit", int(rng.integers(0, FRAMES - 60)), *rows))
        contents = Contents(contents.original, edits, len(edits))
        tell.send(("doing", fingerprint(contents)))
        project.put(contents)
        tell.send(("saving", ""))
        copy = project.save_as(target)
        tell.send(("kept", fingerprint(contents)))
        if rng.random() < 0.5:  # what a program that saved and went on leaves: steps that only the log has
            undone = replace(contents, position=len(edits) - 1)
            tell.send(("doing", fingerprint(undone)))
            copy.put(undone)
            tell.send(("kept", fingerprint(undone)))
        copy.close()


def start(session: object, folder: Path, seed: int) -> tuple[multiprocessing.process.BaseProcess, Connection]:
    """Start a session in a process of its own, from a server that has imported everything already."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["app.session.keeper", "engine.project", "engine.live.spool"])
    told, tell = context.Pipe(duplex=False)
    process = context.Process(target=session, args=(folder, seed, tell), daemon=True)
    process.start()
    tell.close()
    return process, told


def listen(told: Connection, seconds: float) -> list[tuple[str, str]]:
    """Return what a session tells within a time."""
    messages = []
    until = time.perf_counter() + seconds
    while (left := until - time.perf_counter()) > 0:
        if told.poll(left):
            messages.append(told.recv())
    return messages


def listen_to_saves(told: Connection, rng: np.random.Generator) -> list[tuple[str, str]]:
    """Return what a session tells until a moment within one of its saves."""
    messages: list[tuple[str, str]] = []

    def until(kind: str) -> float:
        while not messages or messages[-1][0] != kind:
            messages.append(told.recv())
        return time.perf_counter()

    for _ in range(int(rng.integers(1, SAVES))):
        took_s = -until("saving") + until("kept")
    until("saving")
    return messages + listen(told, float(rng.uniform(0, took_s)))


def kill(process: multiprocessing.process.BaseProcess, told: Connection) -> list[tuple[str, str]]:
    """Kill a session and return what it had told besides."""
    process.kill()  # SIGKILL
    process.join()
    messages = []
    try:
        while True:
            messages.append(told.recv())
    except (EOFError, OSError):
        told.close()
    return messages


def may_be_found(messages: list[tuple[str, str]]) -> tuple[list[str], int]:
    """Return the states that a file may hold after these messages, and how many were reported safe."""
    reached: list[str] = []
    safe, reports = 0, 0
    for kind, text in messages:
        assert kind != "failed", text
        if kind == "doing":
            reached.append(text)
        elif kind == "kept":
            safe, reports = reached.index(text, safe), reports + 1
    return reached[safe:], reports


def edit_a_saved_project_until_killed(folder: Path, seed: int, tell: Connection) -> None:
    """Edit a project that was saved, and go on whatever becomes of its file."""
    from PySide6.QtCore import QCoreApplication

    from app.session import Session
    from app.session.keeper import Keeper

    application, rng = QCoreApplication([]), np.random.default_rng(seed)
    session = Session(Take(weights=rng.random((FRAMES, len(SHAPES))), fps=60.0, name="killed"))
    keeper, saved = Keeper(session, folder), []
    keeper.saved.connect(saved.append)
    keeper.save_as(folder / "scene.retake")
    while not saved:
        application.processEvents()
    keeper.kept.connect(lambda contents: tell.send(("kept", fingerprint(contents))))
    keeper.failed.connect(lambda *sentence: tell.send(("told", " ".join(sentence))))
    tell.send(("doing", fingerprint(session.document.contents())))
    tell.send(("kept", fingerprint(session.document.contents())))
    tell.send(("saved", ""))
    while True:
        push(session, rng, tell)
        wait(application, rng)


SESSIONS = {
    "edit": edit_until_killed,
    "save": save_until_killed,
    "work": edit_and_save_until_killed,
    "replace": edit_a_saved_project_until_killed,
    "export": sessions.export_until_killed,
    "record": sessions.record_until_killed,
}


def check(seed: int, folder: Path, kind: str) -> int:
    """Kill one session and prove that nothing it had reported is lost, and that nothing stray is left.

    Returns how many reports it had made.
    """
    rng = np.random.default_rng(seed)
    process, told = start(SESSIONS[kind], folder, seed)
    longest_s = 4 * LONGEST_S
    new = b""
    try:
        messages = [told.recv()]
        if kind == "replace":
            while messages[-1][0] != "saved":
                messages.append(told.recv())
            messages += listen(told, float(rng.uniform(0, LONGEST_S)))
            new = sessions.replace_by(folder / "scene.retake", sessions.newcomer(folder))
        messages += listen_to_saves(told, rng) if kind == "save" else listen(told, float(rng.uniform(0, longest_s)))
        messages += kill(process, told)
    finally:
        process.kill()
    if new:
        assert (folder / "scene.retake").read_bytes() == new, "the newcomer was written"
    found = sessions.next_start(folder, content_of)
    if kind == "export":
        return sessions.exported(folder, messages)
    if kind == "record":
        return sessions.recorded(folder, messages)
    allowed, reports = may_be_found(messages)
    some = any(content in allowed for content in found)
    assert some or (reports == 0 and not found), f"seed {seed}: an edit that was reported as finished is gone"
    return reports


def content_of(path: Path) -> str:
    """Return the fingerprint of a project, which has to open."""
    opened = Project.open(path)
    try:
        return fingerprint(opened.contents)
    finally:
        opened.close()


def main(seeds: range, kinds: list[str]) -> None:
    """Kill a session for each seed, each kind in turn, and say what came of it."""
    reports, kinds = Counter[str](), kinds or list(SESSIONS)
    losses = []
    for done, seed in enumerate(seeds, 1):
        kind = kinds[seed % len(kinds)]
        with tempfile.TemporaryDirectory() as folder:
            try:
                reports[kind] += check(seed, Path(folder), kind)
            except AssertionError as error:
                losses.append(f"{kind} {seed}: {error}")
                print(losses[-1], flush=True)
        if done % 50 == 0:
            print(f"{done} kills, reports {dict(reports)}, {len(losses)} losses or stray files", flush=True)
    reported = sum(reports.values())
    print(f"{len(seeds)} kills, {reported} finished steps reported before them, {len(losses)} losses or stray files")


if __name__ == "__main__":
    from tests.performance.kills import main  # under its own name, as the sessions' processes know it

    first, _, stop = (sys.argv[1] if len(sys.argv) > 1 else "0:200").rpartition(":")
    main(range(int(first or 0), int(stop)), sys.argv[2:])
