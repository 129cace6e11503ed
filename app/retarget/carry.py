"""What is carried where, and the work of carrying it, off the GUI thread."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from engine.character import Character, bundled, without_lacking
from engine.errors import EditError
from engine.formats.characters.marker_table import MarkerTable
from engine.formats.characters.reading import Reading
from engine.spacetime.layout import Layout, named, standard
from engine.spacetime.matching import Matching
from engine.take import SHAPE_INDEX, Array, Take

if TYPE_CHECKING:
    from engine.formats.characters.assemble import Import
    from engine.spacetime.source import Source

Pose = Mapping[str, float]


class Stopped(Exception):
    """The user wants no more of it."""


@dataclass(frozen=True, eq=False)
class Performance:
    """What is carried: a take on its head, or a capture's markers.

    Attributes
    ----------
    take : frame rate, length, and the weights where there is no capture
    head : whose head the take is on
    capture : markers, in place of the take's weights
    """

    take: Take
    head: Character
    capture: Source | None = None


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


@dataclass(frozen=True, eq=False)
class Carry:
    """A wish to carry frames of a performance to a head.

    Attributes
    ----------
    performance, target, matching : what, where, how
    frames : half-open; all of them where None
    from_labels : by the target's labels instead of by markers
    stop : set to stop it
    """

    performance: Performance
    target: Target
    matching: Matching
    frames: tuple[int, int] | None = None
    from_labels: bool = False
    stop: threading.Event = field(default_factory=threading.Event)


@dataclass(frozen=True, eq=False)
class Carried:
    """What came of it: the weights of frames from `start`, and for labels how loosely they hold each frame."""

    take: Take
    start: int = 0
    uncertainty: Array | None = None

    def weights_at(self, frame: int) -> Array | None:
        """Return the weights of a frame, (52,), where it is among them."""
        inside = self.start <= frame < self.start + len(self.take)
        return np.asarray(self.take.weights[frame - self.start]) if inside else None


@dataclass(frozen=True, eq=False)
class Errand:
    """Work for a background thread, and who gets what it returns."""

    work: Callable[[], Any]
    then: Callable[[Any], None]


class Carrier:
    """Carries; remembers the markers of the last performance, for which a short range is asked again and again."""

    def __init__(self) -> None:
        self._known: tuple[Performance, Source] | None = None

    def source(self, performance: Performance) -> Source:
        """Return the marker motion of a performance."""
        if performance.capture is not None:
            return performance.capture
        if self._known is None or self._known[0] is not performance:
            from engine.spacetime.source import from_take

            self._known = (performance, from_take(performance.take, performance.head))
        return self._known[1]

    def __call__(self, wish: Carry, progress: Callable[[float], None]) -> Carried:
        """Return what the target does; raises `Stopped` when it is told to, else `EngineError`."""

        def tell(share: float) -> None:
            if wish.stop.is_set():
                raise Stopped
            progress(share)

        if wish.from_labels:
            return self._from_labels(wish, tell)
        start, stop = wish.frames or (0, len(wish.performance.take))
        part = _measured(self.source(wish.performance).part(start, stop), wish.target)
        return Carried(self._matched(wish, part, tell), start)

    def _matched(self, wish: Carry, part: Source, tell: Callable[[float], None]) -> Take:
        from engine.spacetime.retarget import retarget

        assert wish.target.head is not None
        layout: Layout | None = named(wish.target.places) if wish.target.places else None
        return retarget(part, wish.target.head, layout=layout, matching=wish.matching, tell=tell)

    def _from_labels(self, wish: Carry, tell: Callable[[float], None]) -> Carried:
        from engine.manifold.retarget import from_labels

        base, points = wish.performance.take, None
        capture = wish.performance.capture
        if capture is not None:  # the labels correct what the markers tell
            base = self._matched(wish, _measured(capture, wish.target), lambda share: tell(share / 2))
            points = points_of(wish.performance)
        labels = {frame: posed(base.weights[frame], pose) for frame, pose in wish.target.labels.items()}
        made = from_labels(base, labels, source=points, tell=tell)
        assert wish.target.head is not None
        return Carried(without_lacking(made.take, wish.target.head), 0, made.uncertainty)


def _measured(source: Source, target: Target) -> Source:
    """Return a capture with lips and lids measured by the landmarks that its markers were corrected to."""
    from engine.spacetime.source import with_gaps

    corrected = any(row.how in ("by hand", "left out") for row in target.markers.rows)
    return with_gaps(source, target.markers.landmarks) if corrected else source


def points_of(performance: Performance) -> Array:
    """Return what tells the frames of a performance apart, (frames, D)."""
    from engine.spacetime.source import bridge

    if performance.capture is None:
        return performance.take.weights
    return bridge(performance.capture.displacements)[0].reshape(len(performance.take), -1)


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
        layout = standard(head)
    except EditError:
        return target
    return replace(target, places=dict(zip(layout.names, layout.vertices.tolist(), strict=True)))


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
