"""What an export says: what was written, and what such a file cannot hold."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from app.session import Session
from engine.take import timecode
from engine.words import NAME_LENGTH, counted, plain


def export_report(session: Session, path: Path, *, saved: bool) -> tuple[str, str]:
    """Return what was written to a file, and what of the session is lost with it: all that is no curve, unless a project has it."""
    take = session.document.take
    name = plain(path.name, longest=NAME_LENGTH)
    length = timecode(take.duration_s, take.fps)
    wrote = f"Wrote {name}: {counted(len(take), 'frame')} at {take.fps:g} fps, {length}."
    missing = _beside_the_curves(session)
    if saved or not missing:
        return wrote, ""
    return wrote, f"A take's file cannot hold {_listed(missing)}. Save the project to keep all of it."


def _beside_the_curves(session: Session) -> list[str]:
    """Return what there is beside the curves, in words."""
    marks = session.document.marks
    marked = sum(span.kind != "lost" for span in marks.spans)
    counts = (
        (len(marks.notes), "note"),
        (len(marks.pins), "pin"),
        (marked, "marked span"),
        (session.document.undo.index(), "step to undo", "steps to undo"),
    )
    found = [counted(count, *words) for count, *words in counts if count]
    found += ["the visemes"] if session.document.visemes is not None else []
    words = {"audio": "the sound", "video": "the reference video"}
    return found + [words[medium.kind] for medium in marks.media if medium.kind in words]


def _listed(words: Sequence[str]) -> str:
    """Return words as a sentence lists them after "cannot hold"."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"
