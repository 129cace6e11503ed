"""The head that a performance is carried to, and how it is read and marked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
    """The head that a performance is carried to.

    Attributes
    ----------
    head : None where none was chosen
    path : the file it came from; None for the bundled one
    places : vertex by marker name
    by_hand : names of those that were placed by hand
    labels : what the head does at a few frames, weights by shape name
    reading : what was corrected when it was read
    imported : what its file's shapes were taken for, and in which frame; None for a head of ours
    markers : what the markers of a capture were taken for; without rows for a take
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
        """Return the wish to have frames of a performance on this head by the movement of its markers."""
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
    """Return a head, read as corrected, with its 54 markers placed; with none where it lacks the landmarks for them."""
    from engine.formats.characters.opening import character_of, is_own
    from engine.formats.characters.reading import import_head

    reading, imported = reading or Reading(), None
    if path is None:
        head = bundled()
    elif is_own(path):
        head = replace(character_of(path), name=path.stem)
    else:
        imported = import_head(path, reading)
        head = replace(imported.character, name=path.stem)
    target = Target(head, path, reading, imported)
    try:
        return replace(target, places=standard_places(head))
    except EditError:
        return target


def with_markers(target: Target, capture: Source, table: MarkerTable) -> Target:
    """Return the target with a capture's markers placed on it: those by hand stay, the others go where they were taken for."""
    from engine.formats.characters.marker_places import places_on

    made = replace(target, markers=table)
    if target.head is None or not table.landmarks:
        return made
    given = {name: target.places[name] for name in capture.names if name in target.by_hand and name in target.places}
    try:
        found = places_on(target.head, capture.neutral, capture.names, table, given)
    except EditError:
        return made  # the head lacks landmarks: they are placed by hand
    others = {name: vertex for name, vertex in target.places.items() if name not in capture.names}  # for a take again
    return replace(made, places={**others, **found})


def with_place(target: Target, name: str, vertex: int | None) -> Target:
    """Return the target with a marker placed by hand, or taken away."""
    places = {each: at for each, at in target.places.items() if each != name or vertex is not None}
    if vertex is None:
        return replace(target, places=places, by_hand=target.by_hand - {name})
    return replace(target, places={**places, name: vertex}, by_hand=target.by_hand | {name})
