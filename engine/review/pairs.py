"""Finds what belongs together: a project and its original, two files, or a folder of pairs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from engine.errors import EditError
from engine.formats import FORMATS
from engine.formats.base.reading import Reading
from engine.project import ENDING
from engine.quality import Dismissal, Flag, dismissal_of, flags_of, parted, seen_of
from engine.review.changes import Comparison, compare
from engine.review.opening import AS_IT_IS, Opened, opened
from engine.review.report import Review

BEFORE, AFTER = "before", "after"
SUFFIXES = ("_after", "_edited", "_clean", "_filled")  # NAME_after.csv is a version of NAME.csv or NAME_before.csv
QUEUE = 10_000  # pairs; a folder of more is a slip


def review(before: Path | None, after: Path, *, offset_s: float | None = None, reading: Reading = AS_IT_IS) -> Review:
    """Return the review of a file against another, or of a project against its own original; `reading` is for takes.

    Raises `EngineError` where a file cannot be read, where there is no original, or no frame in common.
    """
    second = opened(after, reading)
    if before is None:
        compared, earlier = _against_original(second, offset_s)
    else:
        first = opened(before, reading)
        compared = compare(first.take, second.take, offset_s=offset_s, edits=second.edits)
        earlier, _ = parted(first.flags(), first.marks.dismissals)
    counting, dismissed = parted(second.flags(), second.marks.dismissals)
    return Review(
        compared,
        earlier,
        counting,
        second.marks.verdicts,
        second.marks.notes,
        second.edits,
        tuple((flag, _who(flag, second)) for flag in dismissed),
    )


def _against_original(second: Opened, offset_s: float | None) -> tuple[Comparison, tuple[Flag, ...]]:
    """Return a project's take beside what it was made from, which begins with it, and what is found there."""
    original = second.require_original()
    compared = compare(original, second.take, offset_s=offset_s or 0.0, edits=second.edits)
    if not offset_s:
        compared = replace(compared, alignment=replace(compared.alignment, by="start"))
    return compared, flags_of(seen_of(original), second.marks.flags)


def _who(flag: Flag, opened_: Opened) -> Dismissal:
    """Return who dismissed a flag that was dismissed."""
    found = dismissal_of(flag, opened_.marks.dismissals)
    assert found is not None
    return found


def flags(
    path: Path, reading: Reading = AS_IT_IS, *, sound: bool = False, also: Iterable[str] = ()
) -> tuple[Flag, ...]:
    """Return the automatic findings of a take, or of a project with its edits; with `sound`, of the one beside it too.

    Kinds that are not looked for unless somebody says so are, where they are named in `also`. Findings that somebody
    dismissed are left out. Raises `EngineError` where the take or that sound cannot be read.
    """
    found = opened(path, reading)
    counting, _ = parted((found.with_sound() if sound else found).flags(also), found.marks.dismissals)
    return counting


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
