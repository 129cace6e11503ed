"""Whether what a project file says of marks and times can be; types first, since a file may hold anything anywhere."""

from __future__ import annotations

import math
from collections.abc import Iterable
from datetime import UTC, datetime

from engine.project.blobs import DamagedError
from engine.project.records import Edit, Marks, Media, Pin, Span
from engine.project.replaying import visemes_after
from engine.project.reviewing import Drawing, Note, Reply, Verdict
from engine.quality.settings import Dismissal, FlagSettings
from engine.take import SHAPE_INDEX

MAX_WEIGHT = 1e6
MAX_OFFSET_S = 1e7  # four months; nothing was recorded for longer
MAX_MARKS = 1_000_000  # of each kind: as many as a take has frames, since whatever is written must be read again
MAX_TEXT = 100_000_000  # characters of a note
MAX_NAME = 100_000  # characters of a name, a title, a path or a time: a line that is typed holds a third of it
MIN_YEAR, MAX_YEAR = 1900, 9000  # beyond these a time zone may lead out of the calendar
MAX_REPLIES = 10_000  # to a note
MAX_POINTS = 1_000_000  # of a drawing
MAX_PLACE = 1e6  # of a camera, a point or a threshold
CAMERA_NUMBERS = (0, 5, 7)  # none told, the whole head, a part of it
MAX_KINDS = 10_000  # of flags
MEDIA_KINDS = ("audio", "video")


def require(sound: bool, what: str) -> None:
    """Raise `DamagedError` with what is wrong unless all is sound."""
    if not sound:
        raise DamagedError(what)


def require_marks(marks: Marks, length: int) -> None:
    """Raise `DamagedError` where one of the marks cannot belong to a take of so many frames."""
    for what in ("spans", "pins", "notes", "media", "verdicts", "dismissals"):
        stored = getattr(marks, what)
        require(len(stored) <= MAX_MARKS, f"it has {len(stored):,} {what}, and Retake reads at most {MAX_MARKS:,}")
    require(all(_is_span(span, length) for span in marks.spans), "a span is not within the take")
    require(all(_is_pin(pin, length) for pin in marks.pins), "a pin is not within the take, or holds no pose")
    require(all(_is_note(note, length) for note in marks.notes), "a note is not within the take, or no text")
    require(all(_is_medium(media) for media in marks.media), "a sound or video is not described, or begins at no time")
    for verdict in marks.verdicts:
        require_verdict(verdict)
    require(all(_is_dismissal(each, length) for each in marks.dismissals), "a finding that was dismissed is none")
    require(_are_settings(marks.flags), "a threshold of a flag is none")


def require_verdict(verdict: Verdict) -> None:
    """Raise `DamagedError` for a verdict that is none."""
    texts = verdict.judgement, verdict.author, verdict.time
    require(all(_is_text(text) for text in texts) and _is_text(verdict.why, MAX_TEXT), "the verdict is none")


def require_visemes(edits: tuple[Edit, ...]) -> None:
    """Raise `DamagedError` where a step on the visemes does not fit the lane that it finds."""
    try:
        visemes_after(edits)
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
    if not (_are_frames((note.frame, note.frames)) and 0 <= note.frame < note.stop <= length):
        return False
    texts = note.author, note.time, note.region, note.resolved_by, note.resolved_at
    texts_sound = _is_text(note.text, MAX_TEXT) and all(_is_text(text) for text in texts)
    return (
        texts_sound
        and len(note.replies) <= MAX_REPLIES
        and all(map(_is_reply, note.replies))
        and _is_drawing(note.drawing)
    )


def _is_reply(reply: Reply) -> bool:
    return _is_text(reply.text, MAX_TEXT) and _is_text(reply.author) and _is_text(reply.time)


def _is_drawing(drawing: Drawing | None) -> bool:
    if drawing is None:
        return True
    points = [point for stroke in drawing.strokes for point in stroke]
    camera = len(drawing.camera) in CAMERA_NUMBERS and all(_is_number(value, MAX_PLACE) for value in drawing.camera)
    placed = (len(point) == 2 and all(_is_number(value, MAX_PLACE) for value in point) for point in points)
    return camera and len(points) <= MAX_POINTS and all(placed)


def _is_dismissal(each: Dismissal, length: int) -> bool:
    texts = all(_is_text(text) for text in (each.kind, each.sentence, each.author, each.time, each.why))
    whole = _are_frames((each.start, each.stop)) and 0 <= each.start < each.stop <= length
    return texts and whole and _is_number(each.weight, 1.0)


def _are_settings(settings: FlagSettings) -> bool:
    if not (isinstance(settings.counts, dict) and isinstance(settings.thresholds, dict)):
        return False
    if len(settings.counts) + len(settings.thresholds) > MAX_KINDS:
        return False
    names = all(_is_text(name) for name in (*settings.counts, *settings.thresholds))
    counts = all(isinstance(value, bool) for value in settings.counts.values())
    return names and counts and all(_is_number(value, MAX_PLACE) for value in settings.thresholds.values())


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
