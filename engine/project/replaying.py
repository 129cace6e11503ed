"""How the edits of a project play out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.formats import livelink
from engine.formats.base.reading import ReadAs
from engine.formats.livelink.sides import exchange
from engine.project.records import ALIGN, READING, VISEMES, Contents, Edit, read_as_of
from engine.project.visemes import VisemeChange, change_of
from engine.speech.lane import VisemeLane
from engine.take import Array, Mask, Take

Before = tuple[Array, Array, Mask]


@dataclass(frozen=True, eq=False)
class Replayed:
    """What edits come to: the take in effect, the asked values, and the rows that each edit replaced.

    Attributes
    ----------
    take : with the edits up to the position
    asked : (frames, 16), NaN where nothing was asked
    before : of each edit the (frames, 52) weights, (frames, 16) asked values and (frames,) lost frames that it found;
        of one that puts the take before at another time, that take's
    visemes : the lane in effect, if there is one
    changes : of each edit what it did to that lane, None where it did nothing
    original : the take as it was opened, read as it is read by now
    reading : what that is; None where it is read as it was opened
    """

    take: Take
    asked: Array
    before: tuple[Before, ...]
    visemes: VisemeLane | None = None
    changes: tuple[VisemeChange | None, ...] = ()
    original: Take | None = None
    reading: ReadAs | None = None


def replay(contents: Contents) -> Replayed:
    """Return the state at the project's position, bit for bit as it was left."""
    original, position = contents.original, contents.position
    weights, lost = original.weights.copy(), original.lost.copy()
    asked = np.full((len(weights), len(ALL_CONTROLS)), np.nan)
    before: list[Before] = []
    shown = (weights.copy(), asked.copy(), lost.copy())
    found_of, first = _take_before(contents)
    reading: ReadAs | None = None
    for index, edit in enumerate(contents.edits):
        rows = slice(edit.start, edit.stop)
        if edit.kind == ALIGN:
            before.append((found_of[index][0], asked[rows].copy(), found_of[index][1]))
            continue
        before.append((weights[rows].copy(), asked[rows].copy(), lost[rows].copy()))
        lost[rows] = edit.still_lost(weights[rows], lost[rows])
        weights[rows], asked[rows] = edit.weights, edit.asked
        in_effect = index < position
        if in_effect:
            shown[0][rows], shown[1][rows], shown[2][rows] = edit.weights, edit.asked, lost[rows]
        if edit.kind == READING:
            found, target = (read_as_of(edit.inputs[which]) for which in ("before", "after"))
            if found.swapped != target.swapped:
                for curves in (weights, *([shown[0]] if in_effect else [])):
                    curves[:] = exchange(curves)
            reading = target if in_effect else reading
    for array in shown:
        array.flags.writeable = False
    original = contents.original if reading is None else livelink.put(contents.original, reading)
    take = replace(original, weights=shown[0], lost=shown[2])
    if first is not None:
        original = replace(original, weights=first[0], lost=first[1])
    return Replayed(take, shown[1], tuple(before), *visemes_after(contents.edits, contents.position), original, reading)


def _take_before(contents: Contents) -> tuple[dict[int, tuple[Array, Mask]], tuple[Array, Mask] | None]:
    """Return what each edit found that put the take before at another time, and that take as such edits leave it.

    Its (frames, 52) weights and (frames,) lost frames; None where no such edit is in effect.
    """
    if not any(edit.kind == ALIGN for edit in contents.edits):
        return {}, None
    weights, lost = contents.original.weights, contents.original.lost
    shown, found, aligned = (weights, lost), dict[int, tuple[Array, Mask]](), False
    for index, edit in enumerate(contents.edits):
        if edit.kind == ALIGN:
            found[index] = weights, lost
            weights, lost = edit.weights, edit.still_lost(edit.weights, lost)
            aligned = aligned or index < contents.position
        elif (
            edit.kind == READING
            and read_as_of(edit.inputs["before"]).swapped != read_as_of(edit.inputs["after"]).swapped
        ):
            weights = exchange(weights)
        if index < contents.position:
            shown = weights, lost
    return found, shown if aligned else None


def visemes_after(
    edits: Iterable[Edit], position: int = 0
) -> tuple[VisemeLane | None, tuple[VisemeChange | None, ...]]:
    """Return the viseme lane after the first `position` edits, and the change that each of all edits makes to its lane.

    Raises `KeyError`, `TypeError` or `ValueError` where an edit stores a change that its lane does not allow.
    """
    lane = shown = None
    changes: list[VisemeChange | None] = []
    for index, edit in enumerate(edits):
        change = change_of(edit.inputs, lane) if edit.kind == VISEMES else None
        if change is not None:
            lane = change.applied(lane)
        if index < position:
            shown = lane
        changes.append(change)
    return shown, tuple(changes)
