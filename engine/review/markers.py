"""Flags and notes as other programs read them: a table, JSON, and markers for editors as CSV and as CMX 3600 EDL."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from engine.errors import EditError
from engine.quality import KINDS
from engine.review.counting import Counting, counting_of
from engine.review.report import Review, clock
from engine.words import plain

COLUMNS = ("what", "frame", "stop", "time", "kind", "weight", "text", "author", "written", "state", "region")
EDITORS_COLUMNS = ("Marker Name", "Description", "In", "Out", "Duration", "Marker Type", "Color")
MOST_EVENTS = 999  # that an EDL can number
COMMENT = 120  # characters of a locator; some editors cut longer ones
RED, YELLOW, GREEN = ("RED", "ResolveColorRed"), ("YELLOW", "ResolveColorYellow"), ("GREEN", "ResolveColorGreen")
FORMULA = ("=", "+", "-", "@", "\t", "\r")  # a cell that begins so is worked out by a spreadsheet


@dataclass(frozen=True)
class Marker:
    """A flag or a note on the frames start to stop (half-open) of the second take.

    Attributes
    ----------
    what : flag, dismissed or note
    kind : of a flag; empty for a note
    weight : of a flag, 0..1; 1 for a note
    author, written : who and when, empty for a flag
    state : open, done or dismissed
    """

    what: str
    start: int
    stop: int
    kind: str
    weight: float
    text: str
    author: str = ""
    written: str = ""
    state: str = "open"
    region: str = "face"


def markers_of(review: Review) -> tuple[Marker, ...]:
    """Return every flag and note of a review, by their first frame."""
    flags = [Marker("flag", f.start, f.stop, f.kind, f.weight, f.sentence) for f in review.flags_after]
    dismissed = [
        Marker(
            "dismissed", f.start, f.stop, f.kind, f.weight, f"{f.sentence} Dismissed: {who.why}", who.author, who.time
        )
        for f, who in review.dismissed
    ]
    notes = [
        Marker(
            *("note", note.frame, note.stop, "", 1.0),
            "\n".join([note.text, *(f"{reply.author}: {reply.text}" for reply in note.replies)]),
            *(note.author, note.time),
            "done" if note.resolved else "open",
            note.region,
        )
        for note in review.notes
    ]
    return tuple(sorted([*flags, *dismissed, *notes], key=lambda marker: (marker.start, marker.what, marker.stop)))


def as_table(review: Review) -> str:
    """Return flags and notes as CSV, one a line."""
    fps = review.comparison.after.fps
    rows = [
        (
            *(m.what, m.start, m.stop, clock(m.start, fps), m.kind, f"{m.weight:.2f}"),
            *(_cell(m.text), _cell(m.author), m.written, m.state, m.region),
        )
        for m in markers_of(review)
    ]
    return _csv(COLUMNS, rows)


def as_json(review: Review) -> str:
    """Return flags, notes, verdicts and who dismissed what as one JSON object."""
    after = review.comparison.after
    return json.dumps(
        {
            "take": after.name,
            "fps": after.fps,
            "frames": len(after),
            "verdicts": [asdict(verdict) for verdict in review.verdicts],
            "flags": [asdict(flag) for flag in review.flags_after],
            "dismissed": [asdict(who) for _, who in review.dismissed],
            "notes": [asdict(note) for note in review.notes],
        },
        indent=1,
    )


def as_editors_table(review: Review) -> str:
    """Return markers as CSV with the columns that editing programs export, timecodes at the take's rate."""
    counting, first = _clock_of(review)
    rows = []
    for marker in _open(review):
        begin, end = counting.label(first + marker.start), counting.label(first + marker.stop)
        lasting = Counting(counting.rate, counting.base, drop=False).label(marker.stop - marker.start)
        rows.append((_cell(_title(marker)), _cell(marker.text), begin, end, lasting, "Comment", _colour(marker)[0]))
    return _csv(EDITORS_COLUMNS, rows)


def as_edl(review: Review) -> str:
    """Return markers as an edit decision list (CMX 3600) with a locator in each event.

    Each event is one marker: the comment ``* LOC:`` is how Avid writes it, the line with ``|C: |M: |D:`` how Resolve
    does. Timecodes are those of the take, dropped at 29.97 and 59.94 frames per second, which ``FCM:`` says. Of more
    than 999 markers the heaviest are kept, notes first.
    """
    counting, first = _clock_of(review)
    kept = sorted(_open(review), key=lambda marker: (marker.what != "note", -marker.weight))[:MOST_EVENTS]
    lines = [f"TITLE: {_line(review.comparison.after.name)}"]
    lines.append(f"FCM: {'DROP FRAME' if counting.drop else 'NON-DROP FRAME'}")
    for number, marker in enumerate(sorted(kept, key=lambda marker: marker.start), 1):
        begin, end = counting.label(first + marker.start), counting.label(first + marker.stop)
        name, resolve = _colour(marker)
        text = f"{_line(_title(marker))}: {_line(marker.text)}"[:COMMENT]
        lines += [
            "",
            f"{number:03d}  AX       V     C        {begin} {end} {begin} {end}",
            f" |C:{resolve} |M:{text.replace('|', '/')} |D:{marker.stop - marker.start}",
            f"* LOC: {begin} {name:<7} {text}",
        ]
    return "\r\n".join(lines) + "\r\n"


FINDINGS: dict[str, Callable[[Review], str]] = {".csv": as_table, ".json": as_json}
MARKERS: dict[str, Callable[[Review], str]] = {".edl": as_edl, ".csv": as_editors_table}


def writer_for(path: Path, kinds: dict[str, Callable[[Review], str]]) -> Callable[[Review], str]:
    """Return what writes a file by its ending; raises `EditError` for another ending."""
    found = kinds.get(path.suffix.lower())
    if found is None:
        raise EditError(
            f"{path.name} is not a kind of file that can be written here.", f"Use one of: {', '.join(kinds)}."
        )
    return found


def _clock_of(review: Review) -> tuple[Counting, int]:
    """Return how the frames of the second take are labelled, and the number of its first one since midnight."""
    after = review.comparison.after
    counting = counting_of(after.fps)
    return counting, counting.count_at(after.start_s)


def _open(review: Review) -> list[Marker]:
    """Return what somebody has yet to do something about."""
    return [marker for marker in markers_of(review) if marker.state == "open" and marker.what != "dismissed"]


def _title(marker: Marker) -> str:
    return f"Note by {marker.author}" if marker.what == "note" else KINDS[marker.kind].capitalize()


def _colour(marker: Marker) -> tuple[str, str]:
    return GREEN if marker.what == "note" else RED if marker.weight > 0.5 else YELLOW


def _line(text: str) -> str:
    """Return text as one line of ASCII, which is all that an EDL may hold."""
    return plain(text).encode("ascii", "replace").decode()


def _cell(text: str) -> str:
    """Return text that a spreadsheet shows and does not work out."""
    return f"'{text}" if text.startswith(FORMULA) else text


def _csv(columns: tuple[str, ...], rows: Iterable[tuple[object, ...]]) -> str:
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(columns)
    table.writerows(rows)
    return text.getvalue()
