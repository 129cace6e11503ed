"""The source of a retarget: marker displacements without head motion, closures, and shapes that no marker shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from engine.character import Character
from engine.errors import EditError
from engine.formats.markers.capture import Markers
from engine.jaw import drawable
from engine.spacetime.align import HeadMotion, check_points, stillest
from engine.spacetime.closure import GAPS, Gaps
from engine.spacetime.denoise import denoise
from engine.spacetime.layout import Layout, standard
from engine.take import SHAPE_INDEX, Array, Mask, Take, runs
from engine.words import counted

# Pairs of markers that meet, by gap. Lip markers sit on the outside: closed is how far apart they are at rest.
MARKER_GAPS = {
    "lips": ("lip_upper", "lip_lower"),
    "lids_left": ("lid_upper_left", "lid_lower_left"),
    "lids_right": ("lid_upper_right", "lid_lower_right"),
}
LIDS_REST_MM = 10.0  # mm between lid markers of a usual face at rest; a capture's lids are measured relative to it


@dataclass(frozen=True, eq=False)
class Source:
    """A performance as marker displacements from a face at rest, without head motion.

    Attributes
    ----------
    displacements : (frames, n, 3) mm; NaN where a marker was not seen
    neutral : (n, 3) mm, the markers on the face at rest
    names : of the markers
    gaps : (frames, gaps) mm, how far lips and lids are apart, in the order of `GAPS`; NaN where unknown
    take : rate, name, head rotation and lost frames; its weights where they are known, zero otherwise
    head : the head motion that was taken out of a capture's markers; None for a take
    """

    displacements: Array
    neutral: Array
    names: tuple[str, ...]
    gaps: Array
    take: Take
    head: HeadMotion | None = None

    def __len__(self) -> int:
        return len(self.displacements)

    @property
    def is_capture(self) -> bool:
        """Whether the source is a marker capture rather than a take."""
        return self.head is not None

    def part(self, start: int, stop: int) -> Source:
        """Return frames [start, stop), for a preview of the settings."""
        rows = slice(start, stop)
        take = replace(
            self.take,
            weights=self.take.weights[rows],
            lost=self.take.lost[rows],
            rotations=self.take.rotations[rows],
            origin=None,
        )
        head = None if self.head is None else self.head.part(start, stop)
        return replace(self, displacements=self.displacements[rows], gaps=self.gaps[rows], take=take, head=head)


def from_take(take: Take, character: Character, layout: Layout | None = None) -> Source:
    """Return the marker displacements of a character that plays a take."""
    placed = layout or standard(character)
    weights = drawable(take.weights)
    moved = np.einsum("fs,snx->fnx", weights, placed.deltas(character), optimize=True)
    gaps = Gaps(character)
    sizes = np.full((len(take), len(GAPS)), np.nan)
    sizes[:, [GAPS.index(gap) for gap in gaps.gaps]] = gaps.sizes(weights)
    return Source(moved, placed.rest(character), placed.names, sizes, take)


def from_markers(
    markers: Markers,
    *,
    neutral_frame: int = 0,
    turn: Array | None = None,
    landmarks: Mapping[str, str] | None = None,
) -> Source:
    """Return a capture without its head motion, as displacements from a frame with the face at rest.

    Parameters
    ----------
    markers : the capture
    neutral_frame : in which the face is at rest
    turn : (3, 3) rotation from the capture's axes to ours, acting on rows: the head's angles are about its own axes
    landmarks : which standard marker a marker is, by its name, where the two are called differently

    Raises `EditError` where that frame is not there or lacks markers, and where markers coincide or lie in one plane.
    """
    if not 0 <= neutral_frame < len(markers):
        raise EditError(f"Frame {neutral_frame} is not within the capture, which has {counted(len(markers), 'frame')}.")
    neutral = markers.positions[neutral_frame]
    check_points(neutral, markers.names)
    head = stillest(markers.positions, neutral)
    still = head.remove(markers.positions)
    rotations = np.zeros((len(markers), 9))
    rotations[:, :3] = (head if turn is None else head.seen_along(turn)).angles()
    take = Take(
        np.zeros((len(markers), len(SHAPE_INDEX))),
        markers.fps,
        rotations=rotations,
        name=markers.name,
        notices=markers.notices,
    )
    moved = without_jitter(still - neutral)
    source = Source(moved, neutral, markers.names, np.full((len(markers), len(GAPS)), np.nan), take, head)
    return with_gaps(source, landmarks or {})


def with_gaps(source: Source, landmarks: Mapping[str, str]) -> Source:
    """Return a capture with the gaps of lips and lids measured between its markers, where it has them."""
    called = {landmarks.get(name, name): column for column, name in enumerate(source.names)}
    sizes = _gaps(bridge(source.displacements)[0] + source.neutral, source.neutral, called)
    return replace(source, gaps=sizes)


def without_jitter(displacements: Array) -> Array:
    """Remove the tracker's jitter from displacements, (frames, n, 3) mm; gaps stay gaps."""
    return np.where(np.isfinite(displacements), denoise(bridge(displacements)[0]), np.nan)


def _gaps(positions: Array, neutral: Array, columns: Mapping[str, int]) -> Array:
    """Return how far lips and lids are apart, (frames, gaps) mm, of markers in the columns of their landmarks."""
    sizes = np.full((len(positions), len(GAPS)), np.nan)
    for index, gap in enumerate(GAPS):
        pair = MARKER_GAPS.get(gap.name, ())
        if pair and all(name in columns for name in pair):
            upper, lower = (columns[name] for name in pair)
            apart = np.linalg.norm(positions[:, upper] - positions[:, lower], axis=1)
            rest = max(float(np.linalg.norm(neutral[upper] - neutral[lower])), 1e-9)
            lips = gap.name == "lips"
            sizes[:, index] = np.maximum(apart - rest, 0.0) if lips else LIDS_REST_MM * apart / rest
    return sizes


def bridge(displacements: Array) -> tuple[Array, Array]:
    """Interpolate the gaps of displacements, (frames, n, 3), and return the confidence of each step, (frames - 1, n).

    Interpolation is linear; between two sightings g frames apart a step has confidence 1 / g^2, since the marker may have
    been anywhere. Before the first sighting and after the last the position is constant, with confidence 0.
    """
    filled = displacements.copy()
    confidence = np.ones((len(displacements) - 1, displacements.shape[1]))
    frames = np.arange(len(displacements))
    for marker in range(displacements.shape[1]):
        gone: Mask = ~np.asarray(np.isfinite(displacements[:, marker]).all(axis=1))
        if not gone.any():
            continue
        seen = np.flatnonzero(~gone)
        if not len(seen):
            filled[:, marker], confidence[:, marker] = 0.0, 0.0
            continue
        for axis in range(3):
            filled[gone, marker, axis] = np.interp(frames[gone], seen, displacements[seen, marker, axis])
        for start, stop in runs(gone):
            inside = start > 0 and stop < len(gone)
            confidence[max(start - 1, 0) : stop, marker] = 1 / (stop - start + 1) ** 2 if inside else 0.0
    return filled, confidence
