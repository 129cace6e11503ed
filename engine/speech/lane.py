"""Visemes along a take: cues in order, where they begin and end, and what a user may do with them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from engine.errors import EditError
from engine.speech.visemes import NAMES, Cue, begun_at, class_of, require_time
from engine.take import Array

LEAST_S = 0.01  # what a boundary leaves of a cue: what mouth-cue files resolve
INSTANT_S = 1e-6  # a cue that lasts no longer is a point in time
# What the mouth does, by the classes that do it: lanes are coloured by this.
GROUPS: dict[str, tuple[str, ...]] = {
    "silence": ("sil",),
    "lips together": ("mbp",),
    "lip on teeth": ("fv",),
    "rounded": ("ao", "ow", "uw", "w", "r"),
    "spread": ("eh", "iy"),
    "open": ("aa", "ah"),
    "tongue": ("tn", "th", "kg"),
    "teeth together": ("sz", "sh", "jh"),
}
GROUP_OF = np.array([next(i for i, names in enumerate(GROUPS.values()) if name in names) for name in NAMES])


@dataclass(frozen=True, eq=False)
class VisemeLane:
    """Cues in order that do not overlap; an edit makes a new lane.

    Attributes
    ----------
    cues : as edited so far, in seconds of the file
    originals : as they were attached, one for each cue
    source : name of the file
    offset_s : time of the take at which the file begins
    """

    cues: tuple[Cue, ...]
    originals: tuple[Cue, ...]
    source: str = ""
    offset_s: float = 0.0

    @cached_property
    def times_s(self) -> Array:
        """Begin and end of each cue, (cues, 2), in seconds of the take."""
        times = np.array([(cue.start_s, cue.stop_s) for cue in self.cues]).reshape(-1, 2) + self.offset_s
        times.flags.writeable = False
        return times

    @cached_property
    def classes(self) -> np.ndarray:
        """The viseme class of each cue, (cues,) int."""
        known = {label: class_of(label) for label in {cue.label for cue in self.cues}}
        return np.array([known[cue.label] for cue in self.cues], np.int64)

    def at(self, time_s: float) -> int | None:
        """Return the cue at a time of the take."""
        index = int(np.searchsorted(self.times_s[:, 0], time_s, side="right")) - 1
        return index if index >= 0 and time_s < self.times_s[index, 1] else None

    def edge_near(self, time_s: float, within_s: float) -> tuple[int | None, int | None] | None:
        """Return the cues before and after the nearest boundary, None where there is no such cue or boundary.

        A boundary that two cues share belongs to both; beside a pause it belongs to one.
        """
        flat = self.times_s.reshape(-1)
        if not len(flat):
            return None
        after = int(np.searchsorted(flat, time_s))
        nearest = min((i for i in (after - 1, after) if 0 <= i < len(flat)), key=lambda i: abs(flat[i] - time_s))
        if abs(flat[nearest] - time_s) > within_s:
            return None
        cue, is_end = divmod(nearest, 2)
        return self.end_of(cue) if is_end else self.begin_of(cue)

    def begin_of(self, index: int) -> tuple[int | None, int]:
        """Return a cue with the one before it where that ends as this begins."""
        shared = index > 0 and self.cues[index - 1].stop_s == self.cues[index].start_s
        return (index - 1 if shared else None), index

    def end_of(self, index: int) -> tuple[int, int | None]:
        """Return a cue with the one after it where that begins as this ends."""
        shared = index + 1 < len(self.cues) and self.cues[index + 1].start_s == self.cues[index].stop_s
        return index, (index + 1 if shared else None)

    def frames_of(self, index: int, fps: float) -> tuple[int, int]:
        """Return the half-open range of a cue's frames, at least one."""
        start, stop = np.ceil(self.times_s[index] * fps - 0.5).astype(int).tolist()
        return start, max(stop, start + 1)

    def over(self, start_s: float, stop_s: float) -> tuple[Cue, ...]:
        """Return the cues that reach into a stretch of the take, in its seconds."""
        first = int(np.searchsorted(self.times_s[:, 1], start_s, side="right"))
        last = int(np.searchsorted(self.times_s[:, 0], stop_s, side="left"))
        return begun_at(self.cues[first:last], self.offset_s)


def attached(cues: Iterable[Cue], source: str) -> VisemeLane:
    """Return the lane of a file's cues: in order, the earlier of two that overlap ending where the later begins.

    Raises `EditError` for a label that is no viseme or phone, and where no cue lasts.
    """
    found: list[Cue] = []
    lasting = [cue for cue in cues if INSTANT_S < cue.stop_s - cue.start_s < np.inf]  # a point says nothing of how long
    for label in {cue.label for cue in lasting}:
        class_of(label)
    for cue in sorted(lasting, key=lambda each: (each.start_s, each.stop_s)):
        while found and found[-1].stop_s > cue.start_s:
            last = found.pop()
            if cue.start_s - last.start_s > INSTANT_S:
                found.append(replace(last, stop_s=cue.start_s))
                break
        found.append(cue)
    if not found:
        raise EditError(f"{source} holds no cue that lasts.", "Choose a file that says what is said when.")
    return VisemeLane(tuple(found), tuple(found), source)


def with_boundary(lane: VisemeLane, before: int | None, after: int | None, at_s: float) -> VisemeLane:
    """Move the boundary between two cues, or the free end of one, to a time of the take as near as its neighbours allow.

    Both cues keep at least `LEAST_S`; with `before` None the beginning of `after` moves, and the other way round.
    """
    low, high = -np.inf, np.inf
    if before is not None:
        low = lane.cues[before].start_s + LEAST_S
    elif after:
        low = lane.cues[after - 1].stop_s
    if after is not None:
        high = lane.cues[after].stop_s - LEAST_S
    elif before is not None and before + 1 < len(lane.cues):
        high = lane.cues[before + 1].start_s
    if low > high:
        return lane
    to_s = float(np.clip(at_s - lane.offset_s, low, high))
    cues = list(lane.cues)
    if before is not None:
        cues[before] = replace(cues[before], stop_s=to_s)
    if after is not None:
        cues[after] = replace(cues[after], start_s=to_s)
    return replace(lane, cues=tuple(cues))


def renamed(lane: VisemeLane, index: int, label: str) -> VisemeLane:
    """Let a cue say something else; raises `EditError` for what is no viseme or phone."""
    class_of(label)
    cue = replace(lane.cues[index], label=label.strip())
    return replace(lane, cues=(*lane.cues[:index], cue, *lane.cues[index + 1 :]))


def shifted(lane: VisemeLane, offset_s: float) -> VisemeLane:
    """Let the file begin at another time of the take; raises `EditError` for one that is no time."""
    require_time(offset_s)
    return replace(lane, offset_s=float(offset_s))


def restored(lane: VisemeLane) -> VisemeLane:
    """Return the lane as it was attached, where it stands now."""
    return replace(lane, cues=lane.originals)
