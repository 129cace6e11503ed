"""Joins two takes into one that can be opened: the first on the second one's clock, and one edit between them."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.errors import EditError
from engine.formats import read_take
from engine.project import ALIGN, Contents, Edit
from engine.review.align import Alignment, align, on_clock_of
from engine.take import Array, Mask, Take

if TYPE_CHECKING:
    from engine.editing import Patch

COMPARE = "compare"  # kind of the edit that turns a take into another version of it
CHUNK_BYTES = 2**20


@dataclass(frozen=True, eq=False)
class Pair:
    """A take on the clock of another version of it, and that version.

    Attributes
    ----------
    before : the first take, as it was, or on the clock of the second where the two differ in rate or length
    after : the second
    raw : the first take on its own clock
    alignment : how one lies on the other's clock
    same_clock : whether `before` is the first take itself
    apart : how many frames of the second the first has none for; there both are shown alike
    """

    before: Take
    after: Take
    raw: Take
    alignment: Alignment
    same_clock: bool
    apart: int = 0

    @cached_property
    def patch(self) -> Patch:
        """What turns the first take into the second."""
        from engine.editing import Patch  # which loads torch: the window should be seen first

        return Patch.between(self.before, replace(self.after, origin=self.before.origin), (0, len(self.after)))

    @property
    def inputs(self) -> dict[str, Any]:
        """The alignment as a project stores it."""
        found = self.alignment
        return {"offset_s": found.offset_s, "by": found.by, "correlation": found.correlation, "name": self.raw.name}


def pair(before: Take, after: Take, *, offset_s: float | None = None) -> Pair:
    """Return two takes as one that can be opened. Raises `EditError` where they have no frame in common."""
    alignment = align(before, after, offset_s=offset_s)
    same_clock = alignment.offset_s == 0 and before.fps == after.fps and len(before) == len(after)
    if same_clock:
        return Pair(before, after, before, alignment, same_clock=True)
    weights, lost, apart = on_its_clock(before, after, alignment.offset_s)
    moved = Take(weights, after.fps, name=before.name, start_s=after.start_s, lost=lost)
    return Pair(moved, after, before, alignment, same_clock=False, apart=apart)


def on_its_clock(before: Take, after: Take, offset_s: float) -> tuple[Array, Mask, int]:
    """Return a take at the frames of another, (frames, 52), which of them are lost, and how many it has no frame for.

    Where it has none, the other one's rows stand: frames that were never recorded do not count as different. Raises `EditError`
    where the two have no frame in common.
    """
    weights, common = on_clock_of(after, before, offset_s)
    if not common.any():
        raise EditError(f"{before.name} and {after.name} have no frame in common.", "Choose another offset, or take.")
    at = np.clip(np.round((np.arange(len(after)) / after.fps + offset_s) * before.fps), 0, len(before) - 1)
    lost = np.where(common, before.lost[at.astype(np.int64)], after.lost)
    return np.where(common[:, None], weights, after.weights), lost, int((~common).sum())


def compare_edit(found: Pair, inputs: Mapping[str, Any]) -> Edit:
    """Return the edit that turns the first take of a pair into the second."""
    after = found.after
    asked = np.full((len(after), len(ALL_CONTROLS)), np.nan)
    return Edit(COMPARE, f"as in {after.name}", 0, after.weights, asked, {**found.inputs, **inputs}, after.lost)


def align_edit(title: str, weights: Array, lost: Mask, inputs: Mapping[str, Any]) -> Edit:
    """Return the edit that puts the take before at another time, (frames, 52) on the clock of the one after."""
    return Edit(ALIGN, title, 0, weights, np.full((len(weights), len(ALL_CONTROLS)), np.nan), inputs, lost)


def paired_by(edits: Iterable[Edit]) -> Mapping[str, Any] | None:
    """Return the stored alignment of two takes by the edits in effect; None where there is no second take."""
    found = None
    for edit in edits:
        if edit.kind == COMPARE and isinstance(edit.inputs.get("offset_s"), float | int):
            found = dict(edit.inputs)
        elif edit.kind == ALIGN and found is not None:
            found |= edit.inputs
    return found


def alignment_of(stored: Mapping[str, Any]) -> Alignment:
    """Return an alignment from its stored form; what is missing is taken as set by hand."""
    by = stored.get("by")
    correlation = stored.get("correlation")
    return Alignment(
        float(stored["offset_s"]),
        by if by in ("timecode", "correlation", "start") else "offset",
        float(correlation) if isinstance(correlation, float | int) else 0.0,
    )


def contents_of(before: Path, after: Path, *, beside: Path, offset_s: float | None = None) -> Contents:
    """Return what a project at a path holds to review two files; raises `EngineError` as reading and pairing them do."""
    found = pair(read_take(before), read_take(after), offset_s=offset_s)
    inputs = {
        "before": _told(before, beside),
        "after": _told(after, beside),
        "sha256": [sha256(before), sha256(after)],
    }
    return Contents(found.before, (compare_edit(found, inputs),), 1)


def found_again(stored: Mapping[str, Any], project: Path) -> Path | None:
    """Return the path of the first take of a pair's project; None where the file is gone."""
    name = stored.get("before")
    path = (project.parent / name) if isinstance(name, str) and name else None
    return path if path is not None and path.is_file() else None


def sha256(path: Path) -> str:
    """Return the hash of a file's bytes, hexadecimal."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(CHUNK_BYTES):
            digest.update(chunk)
    return digest.hexdigest()


def _told(path: Path, project: Path) -> str:
    """Return a path as seen from a project's folder, with forward slashes; the whole path where there is no such way."""
    try:
        return Path(os.path.relpath(path.resolve(), project.parent.resolve())).as_posix()
    except ValueError:  # another drive
        return path.resolve().as_posix()
