"""Finds what belongs together: a project and its original, two files, or a folder of pairs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from engine.errors import EditError
from engine.formats import FORMATS
from engine.formats.base.reading import Reading
from engine.project import ENDING
from engine.quality import Flag, Seen, flags_of, seen_of
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
        compared, seen = _against_original(second, offset_s)
    else:
        first = opened(before, reading)
        compared, seen = compare(first.take, second.take, offset_s=offset_s, edits=second.edits), first.seen
    return Review(compared, flags_of(seen), flags_of(second.seen), second.marks.verdict, second.remarks, second.edits)


def _against_original(second: Opened, offset_s: float | None) -> tuple[Comparison, Seen]:
    """Return a project's take beside what it was made from, which begins with it, and what is looked at there."""
    original = second.require_original()
    compared = compare(original, second.take, offset_s=offset_s or 0.0, edits=second.edits)
    if not offset_s:
        compared = replace(compared, alignment=replace(compared.alignment, by="start"))
    return compared, seen_of(original)


def flags(path: Path, reading: Reading = AS_IT_IS, *, sound: bool = False) -> tuple[Flag, ...]:
    """Return the automatic findings of a take, or of a project with its edits; with `sound`, of the one beside it too.

    Raises `EngineError` where the take or that sound cannot be read.
    """
    found = opened(path, reading)
    return flags_of((found.with_sound() if sound else found).seen)


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
