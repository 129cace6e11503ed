"""An edit as one pure function: the take below it and the asked curves in, the new weights out.

Each stretch of frames that is asked for is solved apart, from what these frames hold alone:

1. asked curves are granted as far as they are plausible (`plausibility`);
2. the smallest change of the face, as recorded faces vary, that reaches them tells what the other curves do
   (`projection`);
3. the networks make of all curves what a face does over time (`proposal`);
4. their face is brought onto the granted curves, exactly (`projection`).

At the end of an edit, where nothing is asked, its change fades over `feather_s`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import distance_transform_edt, gaussian_filter1d, maximum_filter1d

from engine.controls import ALL_CONTROLS, ALL_INDEX
from engine.easing import ease
from engine.extended import FaceMeasurer, bundled_face
from engine.models.resample import interpolate
from engine.regress.infer import Regressor
from engine.regress.plausibility import DEFAULT_BELIEVABILITY, Plausible
from engine.regress.prior import ONE_WAY_SHAPES, Columns, FacePrior, bundled_prior
from engine.regress.projection import project
from engine.regress.proposal import Proposer
from engine.take import MODEL_FPS, SHAPES, Array, Mask, Take, runs


def _named(*prefixes: str) -> Mask:
    return np.array([name.startswith(prefixes) for name in SHAPES])


_MOUTH = _named("jaw", "mouth", "cheekPuff", "cheekSquint", "noseSneer") & ~_named("mouthClose")
# The shapes that each part of the face may move. mouthClose over an open jaw would close the lips with the least change
# of all, which nobody does.
FREE: dict[str, Mask] = {
    "gaze": _named("eyeLook"),
    "brows": _named("brow"),
    "lower": _MOUTH,
    "eyelids": _named("eyeBlink", "eyeSquint", "eyeWide"),
}
_LIPS, _SIDEWAYS = ALL_INDEX["lips_vertical"], ALL_INDEX["jaw_sideways"]
_CORNERS = [
    ALL_INDEX[name]
    for name in ("lips_horizontal", "corner_right", "corner_left", "corner_height_right", "corner_height_left")
]
_UPRIGHT = [ALL_INDEX[name] for name in ("lips_vertical", "nose_to_lip", "chin_to_lip")]
_SIGNED = np.array([control.signed for control in ALL_CONTROLS])
FADE_FROM = 0.1  # of the largest change asked; its place, unlike that of the first change, is the same at any rate
KNOWN_FRAMES = 256  # up to which the matrix of a spline is kept; it grows with the square of them
ASKED_MM = 1e-7  # a departure from what is there that is one


@dataclass(frozen=True)
class Tuning:
    """Tuned constants of an edit.

    Attributes
    ----------
    stiffness : per mm^2, what moving the skin costs beside how rarely weights go together [0..1000]; 100 made edits of one
        lip, and one-sided ones, a third less unlike recorded motion than covariance alone
    feather_s : seconds beyond what is asked over which the face may still move [0..0.5]
    smooth_s : standard deviation in seconds of the filter over the networks' change [0..0.07]; they answer a little
        otherwise when frames fall otherwise: an edit at 24 and at 120 fps differs by 2 % with it, by 7 % without
    hold_s : seconds over which what is held comes and goes [.05..0.3]; held from one frame to the next, it leaves a notch
    touching_mm, apart_mm : lips nearer than the first stay as near while other curves of the mouth are asked for, lips
        further apart than the second do as they will
    """

    stiffness: float = 100.0
    feather_s: float = 0.2
    smooth_s: float = 0.033
    hold_s: float = 0.2
    touching_mm: float = 1.0
    apart_mm: float = 6.0


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class Stretch:
    """Frames [start, stop) that one edit may move, and what is asked there, (frames, 16), NaN where nothing is."""

    start: int
    stop: int
    asked: Array


class Solver:
    """Solves edits of one take; keeps what stays the same while one of them is dragged.

    Parameters
    ----------
    take : below the edits
    controls : its sixteen curves, (frames, 16), if they have been measured already
    """

    def __init__(
        self,
        take: Take,
        controls: Array,
        regressor: Regressor,
        *,
        tuning: Tuning = TUNING,
        prior: FacePrior | None = None,
        measurer: FaceMeasurer | None = None,
    ) -> None:
        self.take, self.controls, self.tuning = take, controls, tuning
        self._prior = prior or bundled_prior()
        self._measurer = measurer or bundled_face()
        self._proposer = Proposer(regressor)
        self._plausible = Plausible(controls, self._prior)
        metric = self._prior.metric(tuning.stiffness)
        free = FREE | {"aside": FREE["lower"] & ONE_WAY_SHAPES}
        self._covariances = {area: np.where(some[:, None] & some, metric, 0.0) for area, some in free.items()}

    def stretches(self, start: int, asked: Array) -> list[Stretch]:
        """Return the stretches of asked curves, (n, 16) from frame `start`, that can be solved apart.

        Nothing is asked where a value is NaN, nor, at the ends of what is asked of a control, where it is what it was.
        """
        feather = round(self.tuning.feather_s * self.take.fps)
        first, last = max(0, start - feather), min(len(self.take), start + len(asked) + feather)
        own = self.controls[first:last]
        curves = np.full_like(own, np.nan)
        curves[start - first : start - first + len(asked)] = asked
        moved = np.abs(curves - own) > ASKED_MM  # of NaN, it is not
        near = maximum_filter1d(moved.any(axis=1), 2 * feather + 1)
        found = []
        for begin, end in runs(np.asarray(near, bool)):
            wanted = np.full((end - begin, len(ALL_CONTROLS)), np.nan)
            for column in np.flatnonzero(moved[begin:end].any(axis=0)).tolist():
                rows = np.flatnonzero(moved[begin:end, column])
                part = slice(begin + rows[0], begin + rows[-1] + 1)
                curve = curves[part, column]
                wanted[rows[0] : rows[-1] + 1, column] = np.where(np.isnan(curve), own[part, column], curve)
            found.append(Stretch(first + begin, first + end, wanted))
        return found

    def solve(
        self, stretch: Stretch, *, believability: float = DEFAULT_BELIEVABILITY, held: Mask | None = None
    ) -> tuple[Array, Array]:
        """Return weights, (frames, 52), and granted curves, (frames, 16) with NaN where nothing was asked, of a stretch.

        `held`, (frames, 16), are values which edits before asked for: they stay as they are.
        """
        rows = slice(stretch.start, stretch.stop)
        weights, own = self.take.weights[rows], self.controls[rows]
        goal = self._plausible.granted(stretch.asked, own, believability=believability, fps=self.take.fps)
        wanted = ~np.isnan(goal)
        target = np.where(wanted, goal, own)
        if not (np.abs(target - own) > ASKED_MM).any():
            return weights, goal
        moved = np.abs(np.nan_to_num(stretch.asked - own))
        hold = self._hold(moved, wanted, own, held)
        step, frame = self.take.fps / MODEL_FPS, np.arange(len(weights))
        size = (moved / (self._prior.high - self._prior.low)).sum(axis=1)
        at, origin = _model_frames(size, step)
        face, pulled = np.split(_between(np.concatenate([weights, target - own], axis=1), at), [len(SHAPES)], axis=1)
        change = _between(
            self._proposed(face, pulled, interpolate(hold, at), origin=origin),
            np.clip((frame - at[0]) / step, 0, len(at) - 1),
        )
        change *= _fade(size, feather=self.tuning.feather_s * self.take.fps)[:, None]
        proposed = np.clip(weights + change, np.minimum(weights, 0.0), np.maximum(weights, 1.0))
        return self._projected(np.where(change != 0, proposed, weights), target, hold), goal

    def _hold(self, moved: Array, wanted: Mask, own: Array, held: Mask | None) -> Array:
        """Return how firmly each value, (frames, 16), is held, in 0..1: what is asked fully, beside it less and less."""
        hold, frames = wanted.astype(float), self.tuning.hold_s * self.take.fps
        for column in np.flatnonzero(wanted.any(axis=0) & moved.any(axis=0)).tolist():
            beside = _fade(moved[:, column], margin=frames / 2, feather=frames)
            hold[:, column] = np.maximum(hold[:, column], beside)
        if held is not None:
            hold = np.maximum(hold, _beside(held, frames))
        if wanted[:, _CORNERS].any() and not wanted[:, _UPRIGHT].any():
            span = self.tuning.apart_mm - self.tuning.touching_mm
            hold[:, _LIPS] = np.maximum(hold[:, _LIPS], ease((self.tuning.apart_mm - own[:, _LIPS]) / span))
        return hold

    def _proposed(self, weights: Array, pulled: Array, hold: Array, *, origin: int) -> Array:
        """Return the networks' change of weights, (frames, 52), at the model rate, for controls `pulled` so far, (frames, 16)."""
        own = self._measurer.measure(
            weights
        )  # and not between measured frames: these would ask for a change themselves
        target = np.maximum(own + pulled, np.where(_SIGNED, -np.inf, 0.0))
        guess = self._projected(weights, target, hold, roughly=True)
        curves = self._measurer.measure(guess)
        curves = curves + hold * (target - curves)
        areas = tuple(area for area in FREE if hold[:, _columns(area, but=_SIDEWAYS)].any())
        areas += ("jaw",) if hold[:, _SIDEWAYS].any() else ()
        change = self._proposer.change(own, curves, areas, origin=origin)
        return np.asarray(gaussian_filter1d(change, self.tuning.smooth_s * MODEL_FPS, axis=0, mode="nearest"))

    def _projected(self, weights: Array, target: Array, hold: Array, *, roughly: bool = False) -> Array:
        """Return weights, (frames, 52), brought onto the target, (frames, 16), as firmly as it is held."""
        landed = weights
        for area in FREE:
            columns = _columns(area)
            columns = columns[hold[:, columns].any(axis=0)]
            if len(columns):
                covariance = self._covariances["aside" if columns.tolist() == [_SIDEWAYS] else area]
                goal = target[:, columns], hold[:, columns]
                landed = self._area(landed, columns, goal, covariance, roughly)
        return landed

    def _area(
        self, weights: Array, columns: Columns, goal: tuple[Array, Array], covariance: Array, roughly: bool
    ) -> Array:
        target, hold = goal
        whole, landed = hold >= 1.0, weights
        # What is held in part is brought by that part from where it would go by itself; from the same face as what is held
        # fully, so that one turns into the other. Where nothing is held fully, that face is the one there is.
        partly = (hold > 0) & ~whole
        first = np.asarray(whole.any(axis=1, keepdims=True))
        for now in (np.where(first, whole, partly), (hold > 0) & (first & partly.any(axis=1, keepdims=True))):
            rows = np.flatnonzero(now.any(axis=1))
            if len(rows):
                at = landed[rows]
                own = self._measurer.measure(at)[:, columns]
                wanted = np.where(whole[rows], target[rows], own + hold[rows] * (target[rows] - own))
                landed = np.array(landed)
                landed[rows] = project(
                    weights[rows],
                    wanted,
                    columns,
                    hold=now[rows],
                    covariance=covariance,
                    measurer=self._measurer,
                    roughly=roughly,
                )
        return landed


def _columns(area: str, *, but: int = -1) -> Columns:
    return np.array([index for index, control in enumerate(ALL_CONTROLS) if control.area == area and index != but])


def _model_frames(size: Array, step: float) -> tuple[Array, int]:
    """Return the places of frames at the model rate, (n,) in frames, and which of them is the middle of an edit.

    They are laid out from the middle of what is asked, `size` (frames,), so that an edit comes out the same wherever it
    begins and at whatever rate, `step` frames of the take to one of the model's.
    """
    middle = float((np.arange(len(size)) * size).sum() / size.sum())
    middle = round(middle / step, 2) * step  # the same while an edit is dragged further
    before, after = int(middle / step + 1e-6), int((len(size) - 1 - middle) / step + 1e-6)
    return np.asarray(middle + step * np.arange(-before, after + 1), np.float64), before


def _fade(size: Array, *, feather: float, margin: float = 0.0) -> Array:
    """Return 1 on frames where at least a tenth of what is asked most is asked, and beside them 1 to 0 over some frames.

    `size`, (frames,), is how much is asked; the fall takes `feather` frames and begins `margin` frames beside.
    """
    over = size - FADE_FROM * size.max()
    rows = np.flatnonzero(over >= 0)
    first, last = float(rows[0]), float(rows[-1])
    if rows[0] > 0:
        first -= over[rows[0]] / (over[rows[0]] - over[rows[0] - 1])  # where the tenth is, between frames
    if rows[-1] + 1 < len(size):
        last += over[rows[-1]] / (over[rows[-1]] - over[rows[-1] + 1])
    frame = np.arange(len(size))
    return ease(1 - np.maximum(0.0, np.maximum(first - frame, frame - last) - margin) / feather)


def _beside(wanted: Mask, frames: float) -> Array:
    """Return how firmly values, (frames, n), are held that are asked for at some frames: fully there, beside less and less."""
    away = np.stack(
        [distance_transform_edt(~column) if column.any() else np.full(len(column), np.inf) for column in wanted.T]
    )
    return ease(1 - away.T / frames)


def _between(curves: Array, at: Array) -> Array:
    """Return curves, (frames, n), at fractional frames, on a cubic spline through them."""
    if len(curves) < 2:
        return np.repeat(curves[:1], len(at), axis=0)
    if len(curves) > KNOWN_FRAMES:
        return np.asarray(CubicSpline(np.arange(len(curves)), curves)(at))
    return np.asarray(_spline(len(curves), at.tobytes()) @ curves)


@lru_cache(maxsize=8)
def _spline(frames: int, at: bytes) -> Array:
    """Return the matrix, (places, frames), of the spline through frames, which stays the same while an edit is dragged."""
    return np.asarray(CubicSpline(np.arange(frames), np.eye(frames))(np.frombuffer(at)))
