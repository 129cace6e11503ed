"""A folder of pairs as a queue: each has a project with its notes and verdicts, so that nothing judged is lost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from engine import project
from engine.errors import EngineError
from engine.formats.base.content import unread
from engine.project import ENDING, Contents, InUseError, Marks, Project, Verdict, stamp
from engine.review import pairs
from engine.review.pairing import alignment_of, contents_of, paired_by, sha256

FOLDER = "reviews"  # within the folder of pairs
CHANGED = "The take was changed since."


@dataclass(frozen=True)
class Entry:
    """A pair of a queue.

    Attributes
    ----------
    before, after : the two takes
    review : the project that keeps what is said of them; it may not be there yet
    verdict : the one that counts, None where there is none
    trouble : why the project cannot be read, if it cannot
    """

    before: Path
    after: Path
    review: Path
    verdict: Verdict | None = None
    trouble: str = ""

    @property
    def judged(self) -> bool:
        """Whether somebody gave a verdict."""
        return self.verdict is not None and bool(self.verdict.judgement)


def entries(folder: Path) -> tuple[Entry, ...]:
    """Return the pairs of a folder with the verdicts so far; raises `EngineError` where there are none."""
    if not folder.is_dir():
        raise EngineError(f"{folder.name or folder} is not a folder.", "Choose a folder of pairs.")
    found = pairs.pairs(folder)
    return tuple(looked_up(Entry(before, after, folder / FOLDER / f"{after.stem}{ENDING}")) for before, after in found)


def looked_up(entry: Entry) -> Entry:
    """Return an entry with the verdict that its project holds by now."""
    if not entry.review.exists():
        return replace(entry, verdict=None, trouble="")
    try:
        return replace(entry, verdict=project.peek(entry.review).verdict, trouble="")
    except InUseError:
        return replace(entry, trouble="It is open in another Retake.")
    except EngineError as error:
        return replace(entry, trouble=error.sentence)


def progress(queue: Sequence[Entry]) -> str:
    """Return how far the queue is."""
    return f"{sum(entry.judged for entry in queue):,} of {len(queue):,} judged"


def next_open(queue: Sequence[Entry]) -> int:
    """Return the place of the first pair without a verdict, the first of all where each has one."""
    return next((place for place, entry in enumerate(queue) if not entry.judged), 0)


def begun(entry: Entry) -> Path:
    """Return the project of a pair, made where it is not there, and made anew where one of the two takes has changed.

    Notes, verdicts and what was dismissed go over to the new one; the last verdict is taken back, since it was about
    another take. Raises `EngineError` where one cannot be read, they have no frame in common, or nothing can be written.
    """
    old = _kept(entry)
    paired = paired_by(old.edits[: old.position]) if old is not None else None
    if old is not None and not _changed(entry, paired):
        return entry.review
    by_hand = alignment_of(paired).offset_s if paired is not None and paired.get("by") == "offset" else None
    contents = contents_of(entry.before, entry.after, beside=entry.review, offset_s=by_hand)
    if old is not None:
        contents = replace(contents, marks=_carried(old.marks, len(contents.original)))
    try:
        entry.review.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise EngineError(
            f"Reviews cannot be kept in {entry.review.parent}: {(error.strerror or 'unknown reason').lower()}.",
            "Copy the folder to where you may write.",
        ) from error
    project.create(entry.review, contents).close()
    return entry.review


def _kept(entry: Entry) -> Contents | None:
    if not entry.review.exists():
        return None
    opened = Project.open(entry.review, read_only=True)
    try:
        return opened.contents
    finally:
        opened.close()


def _changed(entry: Entry, paired: Any) -> bool:
    """Return whether one of the two takes is another than when the review was begun; one that is gone is not."""
    hashes = paired.get("sha256") if paired is not None else None
    if not isinstance(hashes, list) or len(hashes) != 2:
        return False
    try:
        return [sha256(entry.before), sha256(entry.after)] != hashes
    except OSError as error:
        raise unread(entry.after, error) from error


def _carried(marks: Marks, length: int) -> Marks:
    """Return the marks of a review as far as they lie within a take of another length; the verdict is open again."""
    notes = tuple(
        replace(note, frames=min(note.stop, length) - note.frame) for note in marks.notes if note.frame < length
    )
    dismissals = tuple(each for each in marks.dismissals if each.stop <= length)
    again = (Verdict("", CHANGED, "", stamp()),) if marks.verdict else ()
    return Marks(notes=notes, verdicts=(*marks.verdicts, *again), dismissals=dismissals, flags=marks.flags)
