"""Whether what a project file says of marks and times can be; types first, since a file may hold anything anywhere."""

from __future__ import annotations

import math
from collections.abc import Iterable
from datetime import UTC, datetime

from engine.project.blobs import DamagedError
from engine.project.records import Edit, Marks, Media, Note, Pin, Span
from engine.project.replaying import said
from engine.take import SHAPE_INDEX

MAX_WEIGHT = 1e6
MAX_OFFSET_S = 1e7  # four months; nothing was recorded for longer
MAX_MARKS = 1_000_000  # of each kind: as many as a take has frames, since whatever is written must be read again
MAX_TEXT = 100_000_000  # characters of a note
MAX_NAME = 100_000  # characters of a name, a title, a path or a time: a line that is typed holds a third of it
MIN_YEAR, MAX_YEAR = 1900, 9000  # beyond these a time zone may lead out of the calendar
MEDIA_KINDS = ("audio", "video")


def require(sound: bool, what: str) -> None:
    """Raise `DamagedError` with what is wrong unless all is sound."""
    if not sound:
        raise DamagedError(what)


def require_marks(marks: Marks, length: int) -> None:
    """Raise `DamagedError` where one of the marks cannot belong to a take of so many frames."""
    for held, what in ((marks.spans, "spans"), (marks.pins, "pins"), (marks.notes, "notes"), (marks.media, "media")):
        require(len(held) <= MAX_MARKS, f"it has {len(held):,} {what}, and Retake reads at most {MAX_MARKS:,}")
    require(all(_is_span(span, length) for span in marks.spans), "a span is not within the take")
    require(all(_is_pin(pin, length) for pin in marks.pins), "a pin is not within the take, or holds no pose")
    require(all(_is_note(note, length) for note in marks.notes), "a note is not within the take, or no text")
    require(all(_is_medium(media) for media in marks.media), "a sound or video is not described, or begins at no time")
    require(_is_text(marks.verdict), "the verdict is none")


def require_visemes(edits: tuple[Edit, ...]) -> None:
    """Raise `DamagedError` where a step on the visemes does not fit the lane that it finds."""
    try:
        said(edits)
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
        raise DamagedError("an edit does not say what it did to the visemes") from error


def moment(text: object) -> datetime:
    """Return a time with its zone, UTC where it names none; raises `DamagedError` for one that no calendar has."""
    try:
        when = datetime.fromisoformat(text if isinstance(text, str) else "")
        whole = when if when.tzinfo else when.replace(tzinfo=UTC)
        possible = MIN_YEAR <= whole.year <= MAX_YEAR
    except (ValueError, OverflowError):
        possible = False
    require(possible, "the time of its last change is none")
    return whole


def _is_span(span: Span, length: int) -> bool:
    whole = _are_frames((span.start, span.stop))
    return whole and 0 <= span.start < span.stop <= length and _is_text(span.region) and _is_text(span.kind)


def _is_pin(pin: Pin, length: int) -> bool:
    whole = _are_frames((pin.frame, pin.start, pin.stop))
    return whole and 0 <= pin.start <= pin.frame < pin.stop <= length and _is_pose(pin.weights)


def _is_note(note: Note, length: int) -> bool:
    inside = _are_frames((note.frame,)) and 0 <= note.frame < length
    return inside and _is_text(note.text, MAX_TEXT) and _is_text(note.author) and _is_text(note.time)


def _is_medium(media: Media) -> bool:
    texts = all(_is_text(text) for text in (media.kind, media.path, media.sha256))
    return texts and media.kind in MEDIA_KINDS and _is_number(media.offset_s, MAX_OFFSET_S)


def _is_pose(pose: object) -> bool:
    if not isinstance(pose, dict) or not set(pose) <= set(SHAPE_INDEX):
        return False
    return all(_is_number(value, MAX_WEIGHT) for value in pose.values())


def _are_frames(values: Iterable[object]) -> bool:
    return all(isinstance(value, int) and not isinstance(value, bool) for value in values)


def _is_number(value: object, most: float) -> bool:
    """Return whether a value is a number of at most so much; a whole number of a thousand digits is compared, not converted."""
    if isinstance(value, bool) or not isinstance(value, float | int):
        return False
    return -most <= value <= most and math.isfinite(value)


def _is_text(value: object, most: int = MAX_NAME) -> bool:
    return isinstance(value, str) and len(value) <= most
