"""How far a request is granted: all of it within what this take or the recordings do, and beyond that less and less.

A request is brought to the nearest plausible one, which depends on the request and on the limits alone, not on where the
face is: so what was granted once is granted again, and asking for more never gives less.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.regress.prior import Columns, FacePrior, despiked
from engine.take import Array, Mask


@dataclass(frozen=True)
class Limits:
    """Tuned constants of plausibility limits.

    Attributes
    ----------
    room : of the recorded range, which a control goes beyond it at most at a believability of one half [0.1..0.5]
    share : of recorded faces that lie within the joint limit [.95 .. 1]
    many : curves of one part of the face which, asked together, leave it no way of its own to stay a face
    together : share of recorded faces, and of the take's, that lie within the joint limit of so many [.6 .. 1]; with all
        curves doubled the mouth is 1.5 times as far from a recording as before, at .995 it was 2.5 times
    spike : of the fastest recorded departure, which one of so many may make [.1 .. 1]; with salt and pepper the mouth is
        1.5 times as far as before, at .25 two, at 1 three times; for few curves it would keep blinks from shutting
    """

    room: float = 0.25
    share: float = 0.995
    many: int = 4
    together: float = 0.75
    spike: float = 0.12


LIMITS = Limits()
AREAS = ("lower", "eyelids", "brows", "gaze")
DEFAULT_BELIEVABILITY = 0.5


def room_of(believability: float, limits: Limits = LIMITS) -> float:
    """Return how far beyond recorded limits a request may go, as a share of them: none at 1, without end at 0."""
    return np.inf if believability <= 0 else limits.room * (1 - believability) / believability


class Plausible:
    """Grants requests within what the recordings and one take do.

    Parameters
    ----------
    controls : (all frames, 16) of the take, whose own extremes are plausible whatever others do
    """

    def __init__(self, controls: Array, prior: FacePrior, limits: Limits = LIMITS) -> None:
        self._controls, self._prior, self._limits = controls, prior, limits
        self._furthest: dict[tuple[int, ...], float] = {}

    @cached_property
    def _extremes(self) -> tuple[Array, Array]:
        return self._controls.min(axis=0), self._controls.max(axis=0)

    def granted(self, asked: Array, own: Array, *, believability: float, fps: float) -> Array:
        """Return the asked curves, (frames, 16), as far as they are plausible; NaN in and out where nothing is asked.

        `own`, (frames, 16), is what the face does at these frames: what is granted lies between that and what is asked.
        """
        room = room_of(believability, self._limits)
        if not np.isfinite(room):
            return asked
        wanted: Mask = ~np.isnan(asked)
        # Few curves at once may be as quick as faces are: a blink is. Spikes in many are noise.
        noise = wanted.any(axis=0).sum() >= self._limits.many
        fastest = (self._limits.spike if noise else 1.0) * (1 + room) * self._prior.fastest
        goal = _without_spikes(np.where(wanted, asked, own), own, fastest, fps=fps)
        for area in AREAS:
            columns = np.array([i for i, c in enumerate(ALL_CONTROLS) if c.area == area and wanted[:, i].any()])
            if len(columns) > 1:
                goal[:, columns] = self._within_ball(goal[:, columns], columns, room)
        span, (own_low, own_high) = room * (self._prior.high - self._prior.low), self._extremes
        goal = np.maximum(_eased_off(goal, self._prior.high, span), np.minimum(goal, own_high))
        goal = np.minimum(-_eased_off(-goal, -self._prior.low, span), np.maximum(goal, own_low))
        return np.where(wanted, np.clip(goal, np.fmin(own, asked), np.fmax(own, asked)), np.nan)

    def _within_ball(self, asked: Array, columns: Columns, room: float) -> Array:
        """Return rows, (frames, n), scaled towards the mean face as far as they lie outside the joint limit."""
        many = len(columns) >= self._limits.many
        mean, whiten, radius = self._prior.ball(columns, self._limits.together if many else self._limits.share)
        key = tuple(columns.tolist())
        if key not in self._furthest:
            own = np.linalg.norm((self._controls[:, columns] - mean) @ whiten.T, axis=1)
            self._furthest[key] = float(np.quantile(own, self._limits.together if many else 1.0))
        reach = np.linalg.norm((asked - mean) @ whiten.T, axis=1)
        limit = np.maximum(_eased_off(reach, radius, room * radius), np.minimum(reach, self._furthest[key]))
        scale = limit / np.maximum(reach, 1e-9)
        return np.asarray(mean + scale[:, None] * (asked - mean))


def _without_spikes(asked: Array, own: Array, fastest: Array, *, fps: float) -> Array:
    """Return curves whose departure from their running median is no greater than was recorded, or than the take's own."""
    steady = despiked(asked, fps=fps)
    usual = np.maximum(fastest, np.abs(own - despiked(own, fps=fps)))
    return np.asarray(steady + np.clip(asked - steady, -usual, usual))


def _eased_off(value: Array, limit: Array | float, room: Array | float) -> Array:
    """Return values that go on as asked up to a limit, and beyond it less and less, by no more than some room.

    With a corner at the limit, a curve that is pulled over it would have one too.
    """
    beyond = np.maximum(value - limit, 0.0)
    return np.asarray(np.minimum(value, limit) + room * np.tanh(beyond / np.maximum(room, 1e-9)))
