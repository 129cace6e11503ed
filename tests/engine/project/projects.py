"""Projects to test with."""

from __future__ import annotations

import json
import sqlite3
from pathlib import Path

import numpy as np

from engine import project
from engine.controls import ALL_CONTROLS
from engine.project import Contents, Drawing, Edit, Marks, Media, Note, Pin, Project, Reply, Span, Verdict
from engine.quality import Dismissal, FlagSettings
from engine.take import SHAPES, Take

MARKS = Marks(
    spans=(Span(3, 9), Span(0, 40, "lower", "lost")),
    pins=(Pin(5, {"jawOpen": 0.25, "mouthClose": 1 / 3}, 0, 12),),
    notes=(
        Note(7, "Ana 顔", "2025-01-02T03:04:05+01:00", "the lips\n'stay' open"),
        Note(
            *(9, "Ana", "2025-01-02T03:04:05Z", "<b>on</b> a range", 5, "lower"),
            replies=(Reply("B", "2025-01-02T04:04:05Z", "why?"), Reply("Ana", "", "")),
            resolved_by="B",
            resolved_at="2025-01-03T03:04:05Z",
            drawing=Drawing((((0.0, -0.25), (1 / 3, 0.5)), ((0.1, 0.1),)), (0.0, 4.0, 1.0, 0.0, 0.5)),
        ),
    ),
    media=(Media("audio", "sound/take.wav", "ab" * 32, -0.125),),
    verdicts=(
        Verdict("Approved", "", "Ana", "2025-01-02T03:04:05Z"),
        Verdict("Needs work", "the jaw: it pops", "B", ""),
    ),
    dismissals=(
        Dismissal("open", 3, 8, 1 / 3, "The lips stay 2.1 mm apart.", "Ana", "2025-01-02T03:04:05Z", "a yawn"),
    ),
    flags=FlagSettings({"lost": False}, {"open": 3.5, "of a later Retake": 1.0}),
)


def sample(take: Take) -> Contents:
    return Contents(take, tuple(an_edit(take, seed) for seed in range(4)), 3, MARKS)


def stored(contents: Contents, folder: Path) -> bytes:
    project.create(folder / "a.retake", contents).close()
    return (folder / "a.retake").read_bytes()


def an_edit(take: Take, seed: int) -> Edit:
    rng = np.random.default_rng(seed)
    start = int(rng.integers(0, len(take)))
    frames = int(rng.integers(0, len(take) - start + 1))
    asked = np.where(rng.random((frames, len(ALL_CONTROLS))) < 0.5, np.nan, rng.random((frames, len(ALL_CONTROLS))))
    inputs = {"radius_frames": seed, "exact": bool(seed % 2), "by_mm": np.float64(1 / 3), "curve": np.arange(3.0)}
    return Edit("drag", f"drag {seed} 'lips'", start, rng.random((frames, len(SHAPES))), asked, inputs)


def same(left: Contents, right: Contents) -> bool:
    ours, theirs = left.original, right.original
    assert (ours.fps, ours.name, ours.start_s) == (theirs.fps, theirs.name, theirs.start_s)
    for name in ("weights", "lost", "rotations"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))
    assert (left.position, left.marks, len(left.edits)) == (right.position, right.marks, len(right.edits))
    for one, other in zip(left.edits, right.edits, strict=True):
        assert (one.kind, one.title, one.start) == (other.kind, other.title, other.start)
        as_json = [json.loads(json.dumps(dict(edit.inputs), default=np.ndarray.tolist)) for edit in (one, other)]
        assert as_json[0] == as_json[1]
        np.testing.assert_array_equal(one.weights, other.weights)
        np.testing.assert_array_equal(one.asked, other.asked)
    return True


def reopened(path: Path) -> Contents:
    opened = Project.open(path)
    opened.close()
    return opened.contents


def sql(path: Path, *statements: str, values: tuple[object, ...] = ()) -> None:
    database = sqlite3.connect(path)
    for statement in statements:
        database.execute(statement, values)
    database.commit()
    database.close()
