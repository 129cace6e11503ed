"""Notes in words, as lists and tooltips show them."""

from __future__ import annotations

from app.widgets.times import signed
from engine.project import Note
from engine.review.report import REGION_TITLES
from engine.take import timecode
from engine.words import plain

LINE = 25  # characters of a note's text in a list


def times(note: Note, fps: float) -> str:
    """Return when a note is: a frame, or the first and the last of several."""
    first = timecode(note.frame / fps, fps)
    return first if note.frames == 1 else f"{first}–{timecode((note.stop - 1) / fps, fps)}"


def summary(note: Note, number: int, fps: float) -> tuple[str, str]:
    """Return the two lines of a note in a list: when and where, and what it says."""
    where = "" if note.region in ("face", "") else f" · {plain(REGION_TITLES.get(note.region, note.region))}"
    text = plain(note.text) or "(drawn)"
    more = f"  ↳ {len(note.replies):,}" if note.replies else ""
    room = LINE - len(more)
    short = text if len(text) <= room else f"{text[: room - 1]}…"
    state = "✓ " if note.resolved else ""
    return f"{state}{number}  {times(note, fps)}{where}", f"{short}{more}"


def whole(note: Note) -> str:
    """Return all that a note says: text, who and when, each reply, who resolved it."""
    lines = [plain(note.text, lines=True), signed(note.author, note.time)]
    for reply in note.replies:
        lines += [f"↳ {plain(reply.text, lines=True)}", signed(reply.author, reply.time)]
    if note.resolved:
        lines.append(f"resolved by {signed(note.resolved_by, note.resolved_at)}")
    return "\n".join(line for line in lines if line)
