"""Finds what belongs together: a project and its original, two files, or a folder of pairs."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

from engine.errors import EditError
from engine.formats import FORMATS, audio, read_take
from engine.formats.base.reading import Reading
from engine.project import ENDING, Project, replay
from engine.quality import Dismissal, Flag, FlagSettings, Seen, flags_of, parted, seen_of, sound_of
from engine.review.changes import Edited, compare
from engine.review.report import Remark, Review
from engine.take import Take

BEFORE, AFTER = "before", "after"
SUFFIXES = ("_after", "_edited", "_clean", "_filled")  # NAME_after.csv is a version of NAME.csv or NAME_before.csv
AS_IT_IS = Reading()
QUEUE = 10_000  # pairs; a folder of more is a slip


@dataclass(frozen=True, eq=False)
class _Opened:
    """A file as a reviewer sees it: the take, what it was made from if it tells, notes, verdict and edits.

    Attributes
    ----------
    settings, dismissals : of its project: what is looked for, and what somebody does not mind
    """

    take: Take
    original: Take | None
    seen: Seen
    verdict: str = ""
    remarks: tuple[Remark, ...] = ()
    edits: tuple[Edited, ...] = ()
    settings: FlagSettings = field(default_factory=FlagSettings)
    dismissals: tuple[Dismissal, ...] = ()

    def flags(self, seen: Seen) -> tuple[Flag, ...]:
        """Return what counts of the findings on something that is seen, by the settings of this project."""
        return parted(flags_of(seen, self.settings), self.dismissals)[0]


def review(before: Path | None, after: Path, *, offset_s: float | None = None, reading: Reading = AS_IT_IS) -> Review:
    """Return the review of a file against another, or of a project against its own original; `reading` is for takes.

    Raises `EngineError` where a file cannot be read, where there is no original, or no frame in common.
    """
    opened = _open(after, reading)
    if before is None and opened.original is None:
        raise EditError(
            f"{after.name} does not hold what it was made from.", "Name the take before its edits, then the one after."
        )
    if before is None:
        assert opened.original is not None
        earlier, seen = opened.original, seen_of(opened.original)
    else:
        first = _open(before, reading)
        earlier, seen = first.take, first.seen
    return Review(
        compare(earlier, opened.take, offset_s=offset_s, edits=opened.edits),
        opened.flags(seen),
        opened.flags(opened.seen),
        opened.verdict,
        opened.remarks,
        opened.edits,
    )


def flags(path: Path, reading: Reading = AS_IT_IS, *, sound: bool = False) -> tuple[Flag, ...]:
    """Return the automatic findings of a take, or of a project with its edits; with `sound`, of the one beside it too.

    A project's own thresholds count, and what was dismissed in it is left out.

    Raises `EngineError` where the take or that sound cannot be read.
    """
    opened = _open(path, reading)
    seen = opened.seen
    heard = audio.beside(path) if sound else None
    if heard is not None:
        seen = replace(seen, sound=sound_of(audio.read(heard), fps=seen.fps))
    return opened.flags(seen)


def pairs(folder: Path) -> list[tuple[Path, Path]]:
    """Return the pairs of a folder: equal names in its folders before and after, or NAME.csv beside NAME_after.csv.

    Raises `EditError` where there are none.
    """
    endings = {ending for entry in FORMATS for ending in entry.endings} | {ENDING}

    def takes(inside: Path) -> dict[str, Path]:
        found = sorted(path for path in inside.iterdir() if path.suffix.lower() in endings and path.is_file())
        return {path.stem: path for path in found[:QUEUE]}

    if (folder / BEFORE).is_dir() and (folder / AFTER).is_dir():
        first, second = takes(folder / BEFORE), takes(folder / AFTER)
        found = [(first[stem], second[stem]) for stem in first if stem in second]
    else:
        beside = takes(folder)
        found = []
        for stem, path in beside.items():
            for suffix in SUFFIXES:
                base = stem.removesuffix(suffix)
                earlier = beside.get(base) or beside.get(f"{base}_{BEFORE}")
                if base != stem and earlier is not None:
                    found.append((earlier, path))
                    break
    if not found:
        raise EditError(
            f"{folder.name or folder} holds no pairs of takes.",
            "Put equal names into its folders before and after, or NAME.csv beside NAME_after.csv.",
        )
    return found


def _open(path: Path, reading: Reading) -> _Opened:
    if path.suffix.lower() != ENDING:
        take = read_take(path, reading=reading)
        return _Opened(take, None, seen_of(take))
    project = Project.open(path, read_only=True)
    try:
        contents = project.contents
        state = replay(contents)
    finally:
        project.close()
    edits = tuple(
        Edited(edit.title, edit.start, edit.stop) for edit in contents.edits[: contents.position] if edit.changes_frames
    )
    remarks = tuple(Remark(note.frame, note.author, note.time, note.text) for note in contents.marks.notes)
    original, marks = state.original or contents.original, contents.marks
    seen = seen_of(state.take, original, state.asked, state.visemes)
    return _Opened(state.take, original, seen, marks.verdict, remarks, edits, marks.flags, marks.dismissals)
