"""Retargets performances to other heads: by marker movement, by labelled frames, and meshes by feature points."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from engine.character import Character, without_lacking
from engine.errors import EditError
from engine.patch import Patch
from engine.spacetime.layout import named, standard
from engine.spacetime.matching import Matching
from engine.take import Array, Take

if TYPE_CHECKING:
    from engine.formats.characters.moving import MovingMesh
    from engine.formats.markers.capture import Markers
    from engine.spacetime.source import Source

Progress = Callable[[float], None]  # is called with the share that is done, 0..1; it may raise, to stop
FEWEST_SHARED = 4  # points that have a marker, below which no mesh can be driven


def ignore(_: float) -> None:
    """Ignore the progress."""


@dataclass(frozen=True, eq=False)
class Performance:
    """The source of a retarget: a take on its head, or a capture's markers.

    Attributes
    ----------
    take : frame rate, length, and the weights where there is no capture
    head : whose head the take is on
    capture : markers, in place of the take's weights
    """

    take: Take
    head: Character
    capture: Source | None = None

    @cached_property
    def source(self) -> Source:
        """The performance as marker motion, computed on first use."""
        from engine.spacetime.source import from_take

        return self.capture if self.capture is not None else from_take(self.take, self.head)

    @property
    def features(self) -> Array:
        """The features of its frames, (frames, D): a take's weights, or a capture's marker positions."""
        from engine.spacetime.source import bridge

        if self.capture is None:
            return self.take.weights
        return bridge(self.capture.displacements)[0].reshape(len(self.take), -1)


@dataclass(frozen=True, eq=False)
class RetargetRequest:
    """A performance on another head, by the movement of its markers (SLS12 sections 3 to 5).

    Attributes
    ----------
    head : the target
    places : vertex by marker name; where there are none, the standard ones
    matching : what is respected beside the movement
    frames : half-open; all of them where None
    landmarks : of a capture, the standard marker by a marker's name, where people corrected what was found
    """

    verb: ClassVar[str] = "retarget"
    head: Character
    places: Mapping[str, int] = field(default_factory=dict)
    matching: Matching = field(default_factory=Matching)
    frames: tuple[int, int] | None = None
    landmarks: Mapping[str, str] | None = None

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values, without the head, which is a file of its own."""
        matching = {name: getattr(self.matching, name) for name in ("alpha", "beta", "closure")}
        return {"places": dict(self.places), **matching}


@dataclass(frozen=True, eq=False)
class LabelRequest:
    """A performance on another head, by a few frames at which a person posed it (ZLL17 section 3.2).

    Attributes
    ----------
    labels : weights by shape, by frame; a shape that is not named stays as it is there
    movement : how a capture's markers are matched, which the labels then correct; names the head
    """

    verb: ClassVar[str] = "retarget"
    labels: Mapping[int, Mapping[str, float]]
    movement: RetargetRequest

    @property
    def frames(self) -> tuple[int, int] | None:
        """All frames."""
        return None

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values."""
        return {"labels": {str(frame): dict(pose) for frame, pose in self.labels.items()}, **self.movement.stored()}


@dataclass(frozen=True, eq=False)
class Retargeted:
    """The result of a retarget.

    Attributes
    ----------
    take : the target's weights
    start : the frame of the performance that its first is
    uncertainty : (frames,) how loosely labels hold each frame: the loosest wants the next label; None without labels
    """

    take: Take
    start: int = 0
    uncertainty: Array | None = None

    def weights_at(self, frame: int) -> Array | None:
        """Return the weights of a frame of the performance, (52,), where it is among them."""
        inside = self.start <= frame < self.start + len(self.take)
        return np.asarray(self.take.weights[frame - self.start]) if inside else None

    def patch(self, take: Take) -> Patch:
        """Return the patch that gives a take, as long as the performance, the target's weights."""
        return Patch.between(take, take.with_weights(self.take.weights), (0, len(take)))


def retarget(performance: Performance, request: RetargetRequest, progress: Progress = ignore) -> Retargeted:
    """Return the target's weights that move its markers as the performance's move; raises `EditError`."""
    start, stop = request.frames or (0, len(performance.take))
    source = performance.source if request.frames is None else performance.source.part(start, stop)
    return Retargeted(_matched(source, request, progress), start)


def retarget_from_labels(performance: Performance, request: LabelRequest, progress: Progress = ignore) -> Retargeted:
    """Return the target's weights between the labels; a capture's markers are matched first. Raises `EditError`."""
    from engine.manifold.retarget import from_labels

    base, features = performance.take, None
    if performance.capture is not None:
        base = _matched(performance.capture, request.movement, lambda share: progress(share / 2))
        features = performance.features
    retargeted = from_labels(base, request.labels, source=features, progress=progress)
    return Retargeted(without_lacking(retargeted.take, request.movement.head), 0, retargeted.uncertainty)


def _matched(source: Source, request: RetargetRequest, progress: Progress) -> Take:
    from engine.spacetime.retarget import retarget as by_movement
    from engine.spacetime.source import with_gaps

    measured = source if request.landmarks is None else with_gaps(source, request.landmarks)
    layout = named(request.places) if request.places else None
    return by_movement(measured, request.head, layout=layout, matching=request.matching, progress=progress)


def suggest_frames(performance: Performance, count: int, labelled: Sequence[int] = ()) -> list[int]:
    """Return which frames to label next, best first."""
    from engine.manifold import retarget as labels

    return labels.suggest_frames(performance.features, count, labelled=labelled)


def capture_of(
    markers: Markers, *, neutral_frame: int = 0, turn: Array | None = None, landmarks: Mapping[str, str] | None = None
) -> Source:
    """Return a capture as marker motion without head motion, from a frame in which the face is at rest.

    `turn` and `landmarks` are how its markers were understood (`engine.formats.characters.marker_places`). Raises
    `EditError` where that frame is not there or lacks markers, and where markers coincide or lie in one plane.
    """
    from engine.spacetime.source import from_markers

    return from_markers(markers, neutral_frame=neutral_frame, turn=turn, landmarks=landmarks)


def standard_places(head: Character) -> dict[str, int]:
    """Return the vertex of each of the 54 standard markers; raises `EditError` that names the landmarks a head lacks."""
    layout = standard(head)
    return dict(zip(layout.names, layout.vertices.tolist(), strict=True))


@dataclass(frozen=True, eq=False)
class DriveRequest:
    """A mesh, with shapes or without, that follows feature points (ZLL17 section 3.3).

    Attributes
    ----------
    head : the mesh
    points : the vertex that follows a marker, by the marker's name
    still : whether the head stays where it is
    """

    head: Character
    points: Mapping[str, int]
    still: bool = False


def drive(performance: Performance, request: DriveRequest) -> MovingMesh:
    """Return the mesh over time, in its file's own order of vertices; raises `EditError` for too few points."""
    from engine.formats.characters.moving import MovingMesh
    from engine.manifold.drive import MeshDriver, aim

    source, head = performance.source, request.head
    shared = [name for name in request.points if name in source.names]
    if len(shared) < FEWEST_SHARED:
        raise EditError(f"Only {len(shared)} of the mesh's points have a marker of their name.", "Name them alike.")
    columns = [source.names.index(name) for name in shared]
    rest = head.neutral.astype(np.float64)
    driver = MeshDriver(rest, head.triangles, np.array([request.points[name] for name in shared]))
    aimed, laid = aim(rest[driver.points], source.neutral[columns], source.displacements[:, columns])
    if source.head is not None and not request.still:
        aimed = source.head.seen_along(laid.turn[0], scale=float(laid.scale[0]), shift=laid.shift[0]).apply(aimed)
    posed = [head.as_in_file(frame.astype(np.float32)) for frame in driver.frames(aimed)]
    return MovingMesh(head.as_in_file(rest), head.triangles_in_file, np.stack(posed), source.take.fps)
