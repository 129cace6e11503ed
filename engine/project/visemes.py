"""Steps on the visemes lane: small however long the lane is, and kept with the edits, so that each can be taken back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.errors import EditError
from engine.project.records import VISEMES, Edit
from engine.speech.lane import VisemeLane
from engine.speech.visemes import Cue, class_of
from engine.take import SHAPES

MAX_TIME_S = 1e9


@dataclass(frozen=True, eq=False)
class Head:
    """What a lane is beside its cues."""

    originals: tuple[Cue, ...]
    source: str
    offset_s: float


@dataclass(frozen=True, eq=False)
class VisemeChange:
    """Cues from index `at` on that are replaced, and what the lane is before and after; None where there is none."""

    at: int
    removed: tuple[Cue, ...]
    added: tuple[Cue, ...]
    was: Head | None
    becomes: Head | None

    def applied(self, lane: VisemeLane | None) -> VisemeLane | None:
        """Return the lane after the step, from the one before it."""
        if self.becomes is None:
            return None
        cues = lane.cues if lane is not None else ()
        kept = (*cues[: self.at], *self.added, *cues[self.at + len(self.removed) :])
        return VisemeLane(kept, self.becomes.originals, self.becomes.source, self.becomes.offset_s)

    @property
    def inverse(self) -> VisemeChange:
        """The step back."""
        return VisemeChange(self.at, self.added, self.removed, self.becomes, self.was)


def change_between(before: VisemeLane | None, after: VisemeLane | None) -> VisemeChange:
    """Return the step from one lane to another, as short as it can be told."""
    old, new = (lane.cues if lane is not None else () for lane in (before, after))
    at = 0
    while at < min(len(old), len(new)) and old[at] is new[at]:
        at += 1
    same = 0
    while same < min(len(old), len(new)) - at and old[-1 - same] is new[-1 - same]:
        same += 1
    return VisemeChange(at, old[at : len(old) - same], new[at : len(new) - same], _head(before), _head(after))


def viseme_edit(title: str, change: VisemeChange) -> Edit:
    """Return the edit that changes the visemes and no frame."""
    rows = np.zeros((0, len(SHAPES))), np.zeros((0, len(ALL_CONTROLS)))
    head = change.becomes
    fresh = head is not None and (change.was is None or head.originals is not change.was.originals)
    inputs: dict[str, Any] = {
        "at": change.at,
        "removed": len(change.removed),
        "added": [[cue.start_s, cue.stop_s, cue.label] for cue in change.added],
        "lane": None if head is None else {"source": head.source, "offset_s": head.offset_s, "attached": fresh},
    }
    return Edit(VISEMES, title, 0, *rows, inputs)


def change_of(inputs: Mapping[str, Any], lane: VisemeLane | None) -> VisemeChange:
    """Return the step that an edit tells, on the lane that it found.

    Raises `KeyError`, `TypeError` or `ValueError` where it tells none that this lane could take.
    """
    cues = lane.cues if lane is not None else ()
    at, count = inputs["at"], inputs["removed"]
    if not (isinstance(at, int) and isinstance(count, int) and at >= 0 and count >= 0 and at + count <= len(cues)):
        raise ValueError("the step belongs to another lane")
    added = tuple(_cue(*entry) for entry in inputs["added"])
    stored_lane = inputs["lane"]
    if stored_lane is None:
        return VisemeChange(at, cues[at : at + count], added, _head(lane), None)
    source, offset_s = stored_lane["source"], stored_lane["offset_s"]
    if not isinstance(source, str) or not isinstance(offset_s, float | int) or not abs(offset_s) < MAX_TIME_S:
        raise ValueError("the lane is not described")
    if stored_lane["attached"]:
        originals = (*cues[:at], *added, *cues[at + count :])
    elif lane is None or count != len(added):
        raise ValueError("the lane was never attached")
    else:
        originals = lane.originals
    change = VisemeChange(at, cues[at : at + count], added, _head(lane), Head(originals, source, float(offset_s)))
    _require_order(change.applied(lane), at, len(added))
    return change


def _cue(start_s: object, stop_s: object, label: object) -> Cue:
    times = [time for time in (start_s, stop_s) if isinstance(time, float | int) and abs(time) < MAX_TIME_S]
    if len(times) != 2 or times[0] > times[1] or not isinstance(label, str):
        raise ValueError("a cue is not possible")
    try:
        class_of(label)
    except EditError as error:
        raise ValueError("a cue says nothing known") from error
    return Cue(float(times[0]), float(times[1]), label)


def _require_order(lane: VisemeLane | None, at: int, count: int) -> None:
    """Check the cues that a step put in place, and those beside them; the others were checked before."""
    cues = lane.cues[max(0, at - 1) : at + count + 1] if lane is not None else ()
    if any(cue.stop_s > following.start_s for cue, following in pairwise(cues)):
        raise ValueError("cues overlap")


def _head(lane: VisemeLane | None) -> Head | None:
    return None if lane is None else Head(lane.originals, lane.source, lane.offset_s)
