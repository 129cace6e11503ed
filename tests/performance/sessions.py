"""More sessions for `kills`: exporting, recording, and editing a project that somebody replaces; and what must be left."""

from __future__ import annotations

import os
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from engine.errors import EngineError
from engine.formats import read_take, write_take
from engine.live.record import Recorder
from engine.live.spool import Spool
from engine.live.stream import Arrival
from engine.project import Contents, Project, create
from engine.take import SHAPES, Take

EXPORTED_FRAMES = 1500  # long enough for an export to take a while
RATE = 60.0
PACKETS = 20  # between two saves of a recording
LONGEST = 400  # frames of a recording
STEP = 1e-4  # of a weight, by which versions and recordings are told apart
KINDS_LEFT = (".retake", ".csv")  # what there may be after the next start


def export_until_killed(folder: Path, seed: int, tell: Connection) -> None:
    """Export one version of a take after the other over the same file, which a link leads to."""
    folder.joinpath("shots").mkdir()
    (link := folder / "out.csv").symlink_to(folder / "shots" / "take.csv")
    for version in range(1, 10_000):
        tell.send(("doing", str(version)))
        write_take(Take(weights=np.full((EXPORTED_FRAMES, len(SHAPES)), version * STEP), fps=RATE, name="out"), link)
        tell.send(("kept", str(version)))


def exported(folder: Path, messages: list[tuple[str, str]]) -> int:
    """Prove that the newest export that was reported, or a newer one, is there whole; returns the reports."""
    done = [int(text) for kind, text in messages if kind == "kept"]
    begun = [int(text) for kind, text in messages if kind == "doing"]
    path = folder / "out.csv"
    assert path.is_symlink()
    if done or path.exists():
        weights = read_take(path).weights
        version = round(float(weights[0, 0]) / STEP)
        assert weights.shape == (EXPORTED_FRAMES, len(SHAPES)) and np.allclose(weights, version * STEP, atol=1e-9)
        assert max(done, default=1) <= version <= max(begun)
    return len(done)


def record_until_killed(folder: Path, seed: int, tell: Connection) -> None:
    """Record, end and open one recording after the other; each is kept as unsaved work before its file goes."""
    from PySide6.QtCore import QCoreApplication

    from app.session import Session
    from app.session.keeper import Keeper

    application, rng = QCoreApplication([]), np.random.default_rng(seed)
    session = Session(Take(weights=np.zeros((9, len(SHAPES))), fps=RATE, name="before"))
    keeper, kept = Keeper(session, folder), []
    keeper.kept.connect(kept.append)
    for number in range(1, 10_000):
        recorder = Recorder()
        spool = Spool(recorder, folder / "live.csv")
        row = np.full(len(SHAPES), number * STEP, np.float32)
        for frame in range(int(rng.integers(PACKETS, LONGEST))):
            recorder.add(Arrival(frame / RATE, RATE, row, np.zeros(9, np.float32), late=False))
            if frame % PACKETS == PACKETS - 1:
                spool.save(all_rows=bool(rng.random() < 0.3))
                tell.send(("kept", f"{number} {max(0, frame - int(1.2 * RATE))}"))
        spool.save(all_rows=True)
        take = recorder.take("live")
        tell.send(("kept", f"{number} {len(take)}"))
        session.open(take, None)
        keeper.keep()
        while not any(contents.original is take for contents in kept):
            application.processEvents()
        spool.close(remove=True)


def recorded(folder: Path, messages: list[tuple[str, str]]) -> int:
    """Prove that each recording is there with all that was reported of it; returns the reports."""
    safe: dict[int, int] = {}
    for _, text in messages:
        number, frames = map(int, text.split())
        safe[number] = max(frames, safe.get(number, 0))
    found: dict[int, int] = {}
    for path in folder.glob("*.retake"):
        opened = Project.open(path)
        weights = opened.contents.original.weights
        opened.close()
        number = round(float(weights[0, 0]) / STEP)
        assert np.allclose(weights, number * STEP, atol=1e-6)
        found[number] = max(len(weights), found.get(number, 0))
    short = {number: (frames, found.get(number, 0)) for number, frames in safe.items() if found.get(number, 0) < frames}
    assert not short, f"recordings are shorter than was reported: {short}"
    return len(messages)


def newcomer(folder: Path) -> Path:
    """Make another project that may take the place of one that is open."""
    path = folder / "newcomer"
    create(path, Contents(Take(weights=np.full((2000, len(SHAPES)), 0.5), fps=24.0, name="newcomer"))).close()
    return path


def replace_by(path: Path, new: Path) -> bytes:
    """Let a newcomer take the place of a project; returns what is in it."""
    content = new.read_bytes()
    os.replace(new, path)
    return content


def next_start(folder: Path, content_of: Callable[[Path], str]) -> list[str]:
    """Start again: tidy up, and open each project; returns what they hold. Nothing else may be left."""
    from app.session.left_over import tidy
    from engine.formats.base.atomic import sweep

    tidy(folder)
    for place in [folder, *(path for path in folder.rglob("*") if path.is_dir())]:
        sweep(place)  # as opening a file in it, or writing one, does
    found = []
    for path in sorted(folder.rglob("*.retake")):
        try:
            found.append(content_of(path))
        except EngineError as error:
            raise AssertionError(f"{path.name} does not open: {error}") from error
    stray = [
        (str(path.relative_to(folder)), path.read_bytes()[:60])
        for path in folder.rglob("*")
        if path.is_file() and (path.name.startswith(".") or path.suffix not in KINDS_LEFT or ".partial" in path.name)
    ]
    assert not stray, f"left behind: {stray}"
    return found
