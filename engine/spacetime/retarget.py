"""Retargets markers or a take to another head (SLS12 sections 3 to 5)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from engine.character import Character, without_lacking
from engine.errors import EditError
from engine.spacetime import prior as priors
from engine.spacetime.align import Warp
from engine.spacetime.bounded import Progress, ignore
from engine.spacetime.closure import GAPS, Gaps, closedness
from engine.spacetime.layout import Layout, standard
from engine.spacetime.matching import Matching
from engine.spacetime.prior import Prior
from engine.spacetime.solve import MovementMatcher
from engine.spacetime.source import Source, bridge
from engine.spacetime.system import Position, System
from engine.take import MODEL_FPS, SHAPE_INDEX, SHAPES, Array, Mask, Take
from engine.words import counted


@dataclass(frozen=True)
class Tuning:
    """Settings of a retarget; ranges tried were not recorded."""

    gap_share: float = 0.8  # of the source's gap; errs on the closed side where a gap is nearly closed
    jaw_rounds: int = 8  # of solving again with the jaw at its bound
    over: float = 1e-6  # weight, by which the jaw may exceed its bound
    unseen_mm: float = 0.3  # mm; shapes that move every marker less than this are not solved for


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class Correspondence:
    """The correspondence of a source and a target: the target's shapes at the markers, in the source's proportions.

    Attributes
    ----------
    basis : (3n, m) mm per unit of weight
    shapes : (m,) columns of `SHAPES` that move a marker
    motion : (frames, 3n) mm, gaps interpolated
    confidence : (frames - 1, 3n) in 0..1 of each step, or None where no marker is ever missing
    gap_rows : (3g, m) mm per unit of weight, in the target's own proportions
    gap_places : (frames, 3g) mm, change of the gap vectors from rest to a little less than the source's width
    closedness : (frames, g) in 0..1, of the source
    """

    basis: Array
    shapes: npt.NDArray[np.int64]
    motion: Array
    confidence: Array | None
    gap_rows: Array
    gap_places: Array
    closedness: Array

    @property
    def prior(self) -> Prior:
        """Return the prior of the target's shapes about the face at rest."""
        return priors.from_shapes(self.basis)


def correspond(source: Source, character: Character, layout: Layout | None = None) -> Correspondence:
    """Return the correspondence of a source and a target over the markers they share.

    Raises `EditError` that names what is missing, coincides, or lies on a line or in a plane.
    """
    placed = layout or standard(character)
    shared = [name for name in source.names if name in placed.names]
    if len(shared) < 4:
        raise EditError(
            f"Only {len(shared)} of the source's {counted(len(source.names), 'marker')} can be placed on {character.name!r}.",
            "Name a landmark file that says which vertex carries which marker.",
        )
    placed, columns = placed.pick(shared), [source.names.index(name) for name in shared]
    rest, deltas = placed.rest(character), placed.deltas(character)
    warp = Warp(rest, source.neutral[columns], shared)
    in_source = (warp(rest + deltas) - warp(rest)).reshape(len(SHAPES), -1).T
    shapes = np.flatnonzero(np.linalg.norm(deltas, axis=2).max(axis=1) >= TUNING.unseen_mm)
    motion, confidence = bridge(source.displacements[:, columns])
    gaps = Gaps(character)
    sizes = source.gaps[:, [GAPS.index(gap) for gap in gaps.gaps]]
    return Correspondence(
        basis=np.ascontiguousarray(in_source[:, shapes]),
        shapes=shapes,
        motion=motion.reshape(len(motion), -1),
        confidence=None if (confidence == 1).all() else np.repeat(confidence, 3, axis=1),
        gap_rows=gaps.rows[:, shapes],
        gap_places=_gap_places(gaps, sizes),
        closedness=closedness(sizes, gaps.gaps),
    )


def _gap_places(gaps: Gaps, sizes: Array) -> Array:
    """Return the change of gap vectors, (frames, 3g) mm, to a little less than given widths, (frames, g) mm."""
    towards = gaps.rest / np.maximum(np.linalg.norm(gaps.rest, axis=1, keepdims=True), 1e-9)
    target = TUNING.gap_share * np.where(np.isfinite(sizes), sizes, 0.0)[..., None] * towards
    return np.asarray((target - gaps.rest).reshape(len(sizes), -1))


def with_jaw(pair: Correspondence) -> Correspondence:
    """Return the pair with mouthClose replaced by mouthClose + jawOpen, so that bounds keep mouthClose below jawOpen."""
    jaw, close = _jaw_and_close(pair)
    basis, gap_rows = pair.basis.copy(), pair.gap_rows.copy()
    basis[:, close] += basis[:, jaw]
    gap_rows[:, close] += gap_rows[:, jaw]
    return replace(pair, basis=basis, gap_rows=gap_rows)


def without_jaw(pair: Correspondence, weights: Array) -> Array:
    """Return weights, (frames, m), of the pair itself from those of `with_jaw`."""
    jaw, close = _jaw_and_close(pair)
    apart = weights.copy()
    apart[:, jaw] += apart[:, close]
    return apart


def _jaw_and_close(pair: Correspondence) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return the columns of jawOpen and mouthClose, both empty where the target lacks either."""
    columns = [np.flatnonzero(pair.shapes == SHAPE_INDEX[name]) for name in ("jawOpen", "mouthClose")]
    both = min(len(column) for column in columns)
    return columns[0][:both], columns[1][:both]


def match(pair: Correspondence, fps: float, matching: Matching, progress: Progress = ignore) -> Array:
    """Return weights, (frames, m), by movement matching; `progress` is called with the share done, and may raise to stop.

    The bounds apply to the jaw's two parts, so their sum may exceed the bound. Where it does, it is fixed at the bound and
    everything else is solved for again, until the sum is within the bound everywhere.
    """
    joined = with_jaw(pair)
    weights = _match(joined, fps, matching, progress)
    jaw, close = _jaw_and_close(pair)
    if matching.bounds is None or not len(jaw):
        return without_jaw(pair, weights)
    high, fixed, values = matching.bounds.high, np.zeros(weights.shape, bool), np.zeros_like(weights)
    for _ in range(TUNING.jaw_rounds):
        beyond = np.flatnonzero(weights[:, jaw[0]] + weights[:, close[0]] > high + TUNING.over)
        if not len(beyond):
            break
        both = np.ix_(beyond, [jaw[0], close[0]])
        shut = np.minimum(weights[beyond, close[0]], high)
        fixed[both], values[both] = True, np.stack([high - shut, shut], axis=1)
        weights = _match(joined, fps, matching, lambda _: progress(1.0), fixed=fixed, values=values)
    return np.clip(without_jaw(pair, weights), matching.bounds.low, high)


def _match(
    pair: Correspondence,
    fps: float,
    matching: Matching,
    progress: Progress,
    *,
    fixed: Mask | None = None,
    values: Array | None = None,
) -> Array:
    per_frame = (
        MODEL_FPS / fps
    ) ** 2  # a velocity per frame is smaller at a higher rate; the weights of positions follow it
    prior, frames = pair.prior, len(pair.motion)
    beta = matching.beta * per_frame
    rows, places = pair.basis, pair.motion
    weights = np.full(len(rows), beta)
    closed = matching.closure * per_frame * np.repeat(pair.closedness, 3, axis=1)
    if closed.any():
        rows = np.vstack([rows, pair.gap_rows])
        places = np.hstack([places, pair.gap_places])
        weights = np.hstack([np.broadcast_to(weights, (frames, len(weights))), closed])
    alpha = matching.alpha * per_frame * prior.scale(pair.basis)
    system = System(pair.basis, frames, prior, alpha, Position(rows, weights), pair.confidence)
    matcher = MovementMatcher(system, fixed, bounds=matching.bounds, progress=progress)
    return matcher.solve(pair.motion, places=places, values=values)


def retarget(
    source: Source,
    character: Character,
    *,
    layout: Layout | None = None,
    matching: Matching | None = None,
    progress: Progress = ignore,
) -> Take:
    """Retarget a source to a character; returns the take.

    Parameters
    ----------
    source : from `source.from_take` or `source.from_markers`
    character : the target
    layout : which of its vertices carries which marker; None for the 54 standard ones
    matching : weights of the terms, and bounds
    progress : called with the share that is done, 0..1; it may raise, to stop

    Shapes that move no marker (gaze, tongue) are copied by name where the target has it, and is 0 where it has not; head
    rotation is the source's. Lost frames that move on the target are lost no more. Raises `EditError` as `correspond` does.
    """
    pair = correspond(source, character, layout)
    weights = source.take.weights.copy()
    weights[:, pair.shapes] = match(pair, source.take.fps, matching or Matching(), progress)
    return without_lacking(replace(source.take, origin=None).with_weights(weights), character)
