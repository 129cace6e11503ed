"""What can be done with notes, as marks before and after: nothing here is on the screen."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from engine.project import Drawing, Marks, Note, Reply, stamp


def added(marks: Marks, note: Note) -> Marks:
    """Return marks with one more note."""
    return _with(marks, (*marks.notes, note))


def deleted(marks: Marks, note: Note) -> Marks:
    """Return marks without a note."""
    return _with(marks, (each for each in marks.notes if each is not note))


def exchanged(marks: Marks, old: Note, new: Note) -> Marks:
    """Return marks with a note in place of another."""
    return _with(marks, (new if each is old else each for each in marks.notes))


def rewritten(note: Note, text: str, *, author: str, region: str, drawing: Drawing | None) -> Note:
    """Return a note with another text and region; a drawing takes the place of the one it had."""
    author = author or note.author
    return replace(note, text=text, author=author, time=stamp(), region=region, drawing=drawing or note.drawing)


def answered(note: Note, text: str, *, author: str) -> Note:
    """Return a note with one more reply."""
    return replace(note, replies=(*note.replies, Reply(author, stamp(), text)))


def settled(note: Note, *, author: str) -> Note:
    """Return a note that is done, or open again where it was done."""
    if note.resolved:
        return replace(note, resolved_by="", resolved_at="")
    return replace(note, resolved_by=author, resolved_at=stamp())


def following(notes: Iterable[Note], frame: int, chosen: Note | None, *, by: int) -> Note | None:
    """Return the next open note, or the one before, as seen from a frame; notes on one frame are gone through in turn."""
    listed = tuple(notes)
    here = next((index for index, note in enumerate(listed) if note is chosen and note.frame == frame), None)
    places = [
        index
        for index, note in enumerate(listed)
        if not note.resolved
        and (
            (index - here) * by > 0 and (note.frame - frame) * by >= 0
            if here is not None
            else (note.frame - frame) * by > 0
        )
    ]
    return None if not places else listed[places[0] if by > 0 else places[-1]]


def _with(marks: Marks, notes: Iterable[Note]) -> Marks:
    return replace(marks, notes=tuple(sorted(notes, key=lambda each: each.frame)))
