"""How the edits of a project play out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.project.records import VISEMES, Contents, Edit
from engine.project.visemes import VisemeChange, change_of
from engine.speech.lane import VisemeLane
from engine.take import Array, Take


@dataclass(frozen=True, eq=False)
class Replayed:
    """What edits come to: the take in effect, the asked values, and the rows that each edit replaced.

    Attributes
    ----------
    take : with the edits up to the position
    asked : (frames, 16), NaN where nothing was asked
    before : of each edit the (frames, 52) weights and (frames, 16) asked values that it found
    visemes : the lane in effect, if there is one
    changes : of each edit what it did to that lane, None where it did nothing
    """

    take: Take
    asked: Array
    before: tuple[tuple[Array, Array], ...]
    visemes: VisemeLane | None = None
    changes: tuple[VisemeChange | None, ...] = ()


def replay(contents: Contents) -> Replayed:
    """Return the state at the project's position, bit for bit as it was left."""
    weights = contents.original.weights.copy()
    asked = np.full((len(weights), len(ALL_CONTROLS)), np.nan)
    before: list[tuple[Array, Array]] = []
    shown = (weights.copy(), asked.copy())
    for index, edit in enumerate(contents.edits):
        rows = slice(edit.start, edit.stop)
        before.append((weights[rows].copy(), asked[rows].copy()))
        weights[rows], asked[rows] = edit.weights, edit.asked
        if index < contents.position:
            shown[0][rows], shown[1][rows] = edit.weights, edit.asked
    for array in shown:
        array.flags.writeable = False
    take = contents.original.with_weights(shown[0])
    return Replayed(take, shown[1], tuple(before), *said(contents.edits, contents.position))


def said(edits: Iterable[Edit], position: int = 0) -> tuple[VisemeLane | None, tuple[VisemeChange | None, ...]]:
    """Return the visemes lane after so many edits, and what each of all edits does to the lane that it finds.

    Raises `KeyError`, `TypeError` or `ValueError` where an edit tells a step that its lane could not take.
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
