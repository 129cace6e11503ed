"""The records of a reviewer in a project: notes with replies and drawn marks, and verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

Point = tuple[float, float]


@dataclass(frozen=True)
class Reply:
    """An answer to a note; time is ISO 8601 with its zone."""

    author: str
    time: str
    text: str


@dataclass(frozen=True)
class Drawing:
    """Lines drawn on the picture of a face.

    Attributes
    ----------
    strokes : the points of each line, on the plane through the middle of the head that faced the viewer; x to the right
        and y up from that middle, in parts of the head's height, so that they hold at any zoom and size
    camera : where the face was looked at from: degrees around and above, zoom, pan to the right and up; with two more
        where a part of the face was framed, its width and height. Lengths are in parts of the head's height
    """

    strokes: tuple[tuple[Point, ...], ...]
    camera: tuple[float, ...] = ()


@dataclass(frozen=True)
class Note:
    """A reviewer's remark on a frame, or on several.

    Attributes
    ----------
    frame : the first
    author, time : who wrote it last and when, ISO 8601 with its zone
    text : in their words
    frames : how many it is on
    region : the part of the face that it is on, of `engine.inpaint.regions`
    replies : oldest first
    resolved_by, resolved_at : who called it done and when; empty while it is open
    drawing : what was drawn on the picture, if anything
    """

    frame: int
    author: str
    time: str
    text: str
    frames: int = 1
    region: str = "face"
    replies: tuple[Reply, ...] = ()
    resolved_by: str = ""
    resolved_at: str = ""
    drawing: Drawing | None = None

    @property
    def stop(self) -> int:
        """The frame after the last."""
        return self.frame + self.frames

    @property
    def resolved(self) -> bool:
        """Whether it was called done."""
        return bool(self.resolved_at)


@dataclass(frozen=True)
class Verdict:
    """What a reviewer decided about a take.

    Attributes
    ----------
    judgement : `Approved`, `Needs work`, or nothing where an earlier verdict was taken back
    why : in their words
    author, time : who and when, ISO 8601 with its zone; empty in projects that did not say so yet
    """

    judgement: str
    why: str = ""
    author: str = ""
    time: str = ""

    @property
    def sentence(self) -> str:
        """Judgement and reason as one text."""
        return f"{self.judgement}: {self.why}" if self.why else self.judgement


def stamp() -> str:
    """Return what time it is, ISO 8601 in UTC to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def verdict_from(sentence: str) -> tuple[Verdict, ...]:
    """Return the history that the one text of an older project comes to."""
    judgement, _, why = sentence.partition(": ")
    return (Verdict(judgement, why),) if sentence else ()


def note_of(stored: Mapping[str, Any]) -> Note:
    """Return a note from its `dataclasses.asdict` form; raises `KeyError` or `TypeError` for anything else."""
    parts = dict(stored)
    parts["replies"] = replies_of(parts.get("replies", ()))
    parts["drawing"] = drawing_of(parts.get("drawing"))
    return Note(**parts)


def replies_of(stored: Sequence[Mapping[str, Any]]) -> tuple[Reply, ...]:
    """Return replies from their `dataclasses.asdict` form; raises `TypeError` for anything else."""
    return tuple(Reply(**entry) for entry in stored)


def drawing_of(stored: Mapping[str, Any] | None) -> Drawing | None:
    """Return a drawing from its `dataclasses.asdict` form.

    Raises `KeyError` or `TypeError` for anything else.
    """
    if stored is None:
        return None
    strokes = tuple(tuple(tuple(point) for point in stroke) for stroke in stored["strokes"])
    return Drawing(strokes, tuple(stored["camera"]))  # soundness counts the coordinates
