"""The target of a retarget: a head, how it was read, and its markers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.session.heads import HeadFile, read_head
from engine.character import Character, bundled
from engine.editing import Matching, RetargetRequest, standard_places
from engine.errors import EditError
from engine.formats.characters.marker_table import MarkerTable
from engine.formats.characters.reading import Reading
from engine.take import SHAPE_INDEX, Array

if TYPE_CHECKING:
    from engine.editing import Source
    from engine.formats.characters.assemble import Import

Pose = Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Target:
    """The head that a performance is retargeted to.

    Attributes
    ----------
    head : None where none was chosen
    path : the file it came from; None for the bundled one
    places : vertex by marker name
    by_hand : names of those that were placed by hand
    labels : what the head does at a few frames, weights by shape name
    reading : what was corrected when it was read
    imported : the meaning of its file's shapes, and its frame; None for a head of ours
    markers : the landmark of each marker of a capture; without rows for a take
    """

    head: Character | None = None
    path: Path | None = None
    reading: Reading = field(default_factory=Reading)
    imported: Import | None = None
    markers: MarkerTable = field(default_factory=MarkerTable)
    places: Mapping[str, int] = field(default_factory=dict)
    by_hand: frozenset[str] = frozenset()
    labels: Mapping[int, Pose] = field(default_factory=dict)

    def request(self, matching: Matching, frames: tuple[int, int] | None = None) -> RetargetRequest:
        """Return the request to retarget frames of a performance to this head by the movement of its markers."""
        assert self.head is not None
        corrected = any(row.how in ("by hand", "left out") for row in self.markers.rows)
        landmarks = self.markers.landmarks if corrected else None  # lips and lids are measured by them
        return RetargetRequest(self.head, self.places, matching, frames, landmarks)


@dataclass(frozen=True, eq=False)
class Errand:
    """Work for a background thread, and who gets what it returns."""

    work: Callable[[], Any]
    then: Callable[[Any], None]


def posed(weights: Array, pose: Pose) -> Array:
    """Return weights, (52,), with some of them replaced, by name."""
    changed = weights.copy()
    for name, value in pose.items():
        changed[SHAPE_INDEX[name]] = value
    return changed


def opened(path: Path | None, reading: Reading | None = None) -> Target:
    """Read a head as corrected and place its 54 markers on it; none where it lacks the landmarks for them."""
    reading = reading or Reading()
    read = HeadFile(bundled()) if path is None else read_head(path, reading)
    target = Target(read.head, path, reading, read.imported)
    try:
        return replace(target, places=standard_places(read.head))
    except EditError:
        return target


def with_markers(target: Target, capture: Source, table: MarkerTable) -> Target:
    """Return the target with a capture's markers placed on it: those placed by hand stay, the others go to their landmarks."""
    from engine.formats.characters.marker_places import places_on

    marked = replace(target, markers=table)
    if target.head is None or not table.landmarks:
        return marked
    given = {name: target.places[name] for name in capture.names if name in target.by_hand and name in target.places}
    try:
        found = places_on(target.head, capture.neutral, capture.names, table, given)
    except EditError:
        return marked  # the head lacks landmarks: they are placed by hand
    others = {name: vertex for name, vertex in target.places.items() if name not in capture.names}  # for a take again
    return replace(marked, places={**others, **found})


def with_place(target: Target, name: str, vertex: int | None) -> Target:
    """Return the target with a marker placed by hand, or taken away."""
    places = {each: at for each, at in target.places.items() if each != name or vertex is not None}
    if vertex is None:
        return replace(target, places=places, by_hand=target.by_hand - {name})
    return replace(target, places={**places, name: vertex}, by_hand=target.by_hand | {name})
