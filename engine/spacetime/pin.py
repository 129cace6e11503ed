"""Pins: a pose required exactly at a frame changes a range of frames and keeps their motion (SLS12 section 6)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from engine import exact
from engine.character import Character, bundled
from engine.controls import bundled_measurer, control_index
from engine.errors import EditError
from engine.jaw import follow, limited
from engine.pose import Pose, filled
from engine.spacetime import prior
from engine.spacetime.closure import Gaps
from engine.spacetime.layout import standard
from engine.spacetime.solve import MovementMatcher
from engine.spacetime.system import Position, System
from engine.take import SHAPES, Array, Mask, Take, require_frames, runs
from engine.words import counted

FARTHEST_MM = 1000.0


@dataclass(frozen=True)
class Tuning:
    """Settings of closing what clipping has opened; ranges tried were not recorded."""

    opened_mm: float = 0.05  # mm; smaller openings are invisible
    rounds: int = 8  # of damped Gauss-Newton steps
    damping_mm2: float = 0.5  # mm^2


TUNING = Tuning()


@dataclass(frozen=True)
class Spreading:
    """The weights of the terms by which a pin changes its range.

    Attributes
    ----------
    alpha : weight of the prior, which lets small shapes return before large ones; 0 spreads evenly over the range
    closure : weight by which lips and lids that meet in the take keep meeting, relative to the match of velocities
    stiffness : cost of any motion of a shape, so that few shapes close a gap instead of many that cancel
    """

    alpha: float = 0.0
    closure: float = 300000.0
    stiffness: float = 0.1


class Spread:
    """Spreads changes of some frames over a motion, keeping its velocities and its closures.

    With X = W - W0 it minimises ``|D X B'|^2 + stiffness |D X|^2 + alpha prior(X) + closure c |gaps(X)|^2``, the fixed
    weights given: SLS12 equation 4 and section 7.1 with the take W0 itself as the source, so that no pin is no change.
    c is the degree of closure of W0's gaps, and 0 for a closure during which there is a pin: the pin decides.
    The constructor factorises; a call only substitutes.

    Parameters
    ----------
    motion : (f, 52), W0
    fixed : (f, 52) bool, weights whose values a call is given
    pins : frames among the fixed ones that are pins rather than the range's edges
    spreading : weights of the terms
    character : whose markers and gaps are matched
    """

    def __init__(
        self,
        motion: Array,
        fixed: Mask,
        pins: Iterable[int],
        *,
        spreading: Spreading | None = None,
        character: Character | None = None,
    ) -> None:
        how, face = spreading or Spreading(), _face(character or bundled())
        self._motion, self._fixed = motion, fixed
        self._gaps, self._closedness = (
            face.gaps,
            (how.closure > 0) * _without_pinned(face.gaps.closedness(motion), pins),
        )
        closed = how.closure * np.repeat(self._closedness, 3, axis=1)
        closed[fixed.all(axis=1)] = 0.0
        position = Position(face.gaps.rows, closed) if closed.any() else None
        alpha = how.alpha * face.prior.scale(face.basis)
        system = System(face.basis, len(motion), face.prior, alpha, position, stiffness=how.stiffness)
        self._matcher = MovementMatcher(system, fixed)

    def __call__(self, values: Array) -> Array:
        """Return the new motion, (f, 52), for values, (f, 52), of which the fixed ones are met exactly.

        The other weights are clipped to 0..1, or to the motion's own value beyond it.
        """
        change = np.where(self._fixed, values - self._motion, 0.0)
        moved = self._motion + self._matcher.settle(np.zeros_like(change), change)
        within = np.clip(moved, np.minimum(self._motion, 0.0), np.maximum(self._motion, 1.0))
        return self._closed_again(np.where(self._fixed, values, within))

    def _closed_again(self, moved: Array) -> Array:
        """Close what clipping has opened, by damped Gauss-Newton steps of the weights, frame by frame."""
        before = self._gaps.sizes(limited(self._motion))
        opened = np.maximum(self._gaps.sizes(limited(moved)) - before, 0.0) * self._closedness
        rows = np.flatnonzero((opened > TUNING.opened_mm).any(axis=1) & ~self._fixed.any(axis=1))
        closed = moved.copy()
        for _ in range(TUNING.rounds if len(rows) else 0):
            closed[rows] += self._closing(closed[rows], before[rows], self._closedness[rows])
            closed[rows] = np.clip(closed[rows], np.minimum(moved[rows], 0.0), np.maximum(moved[rows], 1.0))
        return closed

    def _closing(self, weights: Array, before: Array, closedness: Array) -> Array:
        """Return a damped Gauss-Newton step, (n, 52), of the gaps to their widths before, (n, g) mm, by degree of closure."""
        gaps = self._gaps
        vectors = gaps.rest + (limited(weights) @ gaps.rows.T).reshape(len(weights), -1, 3)
        sizes = np.linalg.norm(vectors, axis=2)
        slope = np.einsum(
            "ngx,gxs->ngs", vectors / np.maximum(sizes, 1e-9)[..., None], gaps.rows.reshape(-1, 3, len(SHAPES))
        )
        follow(slope, weights)
        missing = -np.maximum(sizes - before, 0.0) * closedness
        slope = np.where(((weights <= 0.0) & (np.einsum("ngs,ng->ns", slope, missing) < 0))[:, None, :], 0.0, slope)
        gram = slope @ slope.transpose(0, 2, 1) + TUNING.damping_mm2 * np.eye(slope.shape[1])
        return np.asarray(np.einsum("ngs,ng->ns", slope, np.linalg.solve(gram, missing[..., None])[..., 0]))


@dataclass(frozen=True, eq=False)
class _Face:
    basis: Array
    prior: prior.Prior
    gaps: Gaps


@lru_cache(maxsize=4)
def _face(character: Character) -> _Face:
    basis = standard(character).deltas(character).reshape(len(SHAPES), -1).T
    return _Face(basis, prior.from_shapes(basis), Gaps(character))


def _without_pinned(closedness: Array, pins: Iterable[int]) -> Array:
    """Return closedness, (f, g), with 0 for the closures during which there is a pin."""
    kept = closedness.copy()
    for frame in pins:
        for gap in np.flatnonzero(closedness[frame] > 0):
            start, stop = next(run for run in runs(closedness[:, gap] > 0) if run[0] <= frame < run[1])
            kept[start:stop, gap] = 0.0
    return kept


class PinSolver:
    """Solves for the pins of a take over a range; factorised once, so that another pose of the same pins is cheap.

    Parameters
    ----------
    take : what is edited
    pins : pose by frame; which weights are pinned is fixed here, their values may change with each `solve`
    frames : half-open range outside which nothing changes; the frames beside it are its boundary
    whole : a pin without some weight pins that weight to the take's value; otherwise such weights are free
    spreading : weights of the terms

    Raises
    ------
    EditError : for a pin outside the range, an unknown shape, or a range outside the take
    """

    def __init__(
        self,
        take: Take,
        pins: Mapping[int, Pose],
        frames: tuple[int, int],
        *,
        whole: bool = True,
        spreading: Spreading | None = None,
    ) -> None:
        self._take, self._whole, self._frames = take, whole, frames
        _check(take, pins, frames)
        self._first, last = max(frames[0] - 1, 0), min(frames[1] + 1, len(take))
        self._motion = take.weights[self._first : last]
        self._pinned = {frame: self._mask(pose) for frame, pose in pins.items()}
        fixed = np.zeros(self._motion.shape, bool)
        fixed[: frames[0] - self._first] = True
        fixed[frames[1] - self._first :] = True
        for frame, mask in self._pinned.items():
            fixed[frame - self._first] = mask
        self._spread = Spread(self._motion, fixed, [frame - self._first for frame in pins], spreading=spreading)

    def _mask(self, pose: Pose) -> Mask:
        return np.ones(len(SHAPES), bool) if self._whole else np.isfinite(filled(pose))

    def solve(self, pins: Mapping[int, Pose]) -> Array:
        """Return the weights of the range, (stop - start, 52), for new values of the same pins."""
        values = self._motion.copy()
        if pins.keys() != self._pinned.keys():
            raise EditError("The pins are at other frames than before.", "Prepare the range again.")
        for frame, pose in pins.items():
            pose_row = filled(pose)
            if not self._whole and not np.array_equal(np.isfinite(pose_row), self._pinned[frame]):
                raise EditError("The pins hold other weights than before.", "Prepare the range again.")
            values[frame - self._first] = np.where(np.isfinite(pose_row), pose_row, values[frame - self._first])
        start, stop = self._frames
        return self._spread(values)[start - self._first : stop - self._first]

    def take(self, pins: Mapping[int, Pose]) -> Take:
        """Return the take with new values of the same pins; known frames outside the range are bit-identical."""
        start, stop = self._frames
        found = np.isin(np.arange(start, stop), list(pins))
        return self._take.with_rows(start, self.solve(pins), found=found)


def pin(
    take: Take,
    pins: Mapping[int, Pose],
    frames: tuple[int, int],
    *,
    whole: bool = True,
    spreading: Spreading | None = None,
) -> Take:
    """Pin poses of a take over a half-open range; parameters and errors as `PinSolver`."""
    return PinSolver(take, pins, frames, whole=whole, spreading=spreading).take(pins)


def pose_reaching(take: Take, frame: int, controls: Mapping[str, float]) -> Array:
    """Return the pose, (52,), nearest to a frame's at which controls have given values in mm, as far as weights allow."""
    if not 0 <= frame < len(take):
        raise EditError(f"Frame {frame} is not within the take, which has {counted(len(take), 'frame')}.")
    columns = np.array([control_index(name) for name in controls])
    target = np.array([list(controls.values())], float)
    if not (np.abs(target) <= FARTHEST_MM).all():
        raise EditError(f"A control is pinned to something that is not a number within {FARTHEST_MM:,.0f} mm.")
    here = take.weights[frame : frame + 1]
    every = np.ones(len(SHAPES), bool)
    return np.asarray(exact.project(here, target, columns, bundled_measurer(), free=every)[0])


def _check(take: Take, pins: Mapping[int, Pose], frames: tuple[int, int]) -> None:
    start, stop = frames
    require_frames(take, start, stop)
    if not pins:
        raise EditError("There is no pin to spread.", "Pin a pose at a frame of the range.")
    for frame in pins:
        if not start <= frame < stop:
            raise EditError(f"The pin at frame {frame} is not within the range {start}:{stop}.", "Widen the range.")
