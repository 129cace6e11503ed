"""How far a request is granted: all of it within what this take or the recordings do, and beyond that less and less.

A request of few curves is brought to the nearest plausible one, which depends on the request and on the limits alone, not
on where the face is: so what was granted once is granted again, and asking for more never gives less. One of so many that
they leave the face no way of its own is drawn back towards the take, as far as it is no face that most are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

from engine.controls import ALL_CONTROLS, ALL_INDEX, CONTROLS
from engine.easing import ease
from engine.regress.prior import Columns, FacePrior, despiked
from engine.take import Array, Mask


@dataclass(frozen=True)
class Limits:
    """Tuned constants of plausibility limits.

    Attributes
    ----------
    room : of the recorded range, which a control goes beyond it at most at a believability of one half [0.1..0.5]
    share : of recorded faces that lie within the joint limit [.95 .. 1]
    many : of the mouth's six distances, which asked together leave it no way of its own to stay a face [4..6]; a smile by
        the places and heights of both corners and the mouth's width asks for three of them
    together : share of recorded faces, and of the take's, that lie within the joint limit of so many [.5 .. .9]; at .9 a
        face with all curves doubled is 1.5 times as far from a recording as the take is, at .75 1.1 times
    about_s : seconds around a frame that is drawn back, over which its neighbours are too [0 .. .8]; so the form of a
        motion stays. Without it a face with all curves doubled moves unlike faces, 1.2 times as far from them
    near_s : seconds on either side, within which what the take does is plausible at a frame [0, 1]; at 0 a mouth held as it
        was a second ago is reached by .84, and motion halved by .79
    quick, noisy : departures as quick as were ever recorded, at once on average over `spell_s`: so many are gestures, as a
        blink of both eyes is, so many are noise [.3 .. 2]
    spell_s : seconds over which they are counted [.3 .. 1]
    spike : of the fastest recorded departure, which one in noise may make [.1 .. 1]; with salt and pepper the mouth is 1.5
        times as far as before, at .25 two, at 1 three times
    """

    room: float = 0.25
    share: float = 0.995
    many: int = 5
    together: float = 0.75
    about_s: float = 0.13
    near_s: float = 1.0
    quick: float = 0.4
    noisy: float = 0.9
    spell_s: float = 0.67
    spike: float = 0.12


LIMITS = Limits()
AREAS = ("lower", "eyelids", "brows", "gaze")
DEFAULT_BELIEVABILITY = 0.5
_LIPS = ALL_INDEX["lips_vertical"]


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
        self._furthest: dict[tuple[float, ...], float] = {}

    @cached_property
    def _extremes(self) -> tuple[Array, Array]:
        return self._controls.min(axis=0), self._controls.max(axis=0)

    def granted(self, asked: Array, own: Array, *, believability: float, fps: float) -> Array:
        """Return the asked curves, (frames, 16), as far as they are plausible; NaN in and out where nothing is asked.

        Beside many curves of the mouth, though, lips that nothing is asked of stay as they are.
        `own`, (frames, 16), is what the face does at these frames: what is granted lies between that and what is asked.
        """
        room = room_of(believability, self._limits)
        if not np.isfinite(room):
            return asked
        wanted: Mask = ~np.isnan(asked)
        goal = self._without_spikes(np.where(wanted, asked, own), own, wanted, (1 + room, fps))
        every = self._all_at_once(wanted)
        for area in AREAS:
            columns = np.array([i for i, c in enumerate(ALL_CONTROLS) if c.area == area and wanted[:, i].any()])
            if area in every:
                goal[:, columns] = self._drawn_back(goal[:, columns], own[:, columns], columns, fps=fps)
            elif len(columns) > 1:
                goal[:, columns] = self._within_ball(goal[:, columns], columns, room)
        span, (own_low, own_high) = room * (self._prior.high - self._prior.low), self._extremes
        goal = np.maximum(_eased_off(goal, self._prior.high, span), np.minimum(goal, own_high))
        goal = np.minimum(-_eased_off(-goal, -self._prior.low, span), np.maximum(goal, own_low))
        granted = np.where(wanted, np.clip(goal, np.fmin(own, asked), np.fmax(own, asked)), np.nan)
        if every and not wanted[:, _LIPS].any():  # so many would pull lips apart that touch, which nothing asked for
            granted[:, _LIPS] = own[:, _LIPS]
        return granted

    def _all_at_once(self, wanted: Mask) -> tuple[str, ...]:
        """Return the areas whose curves are asked for so many together that they leave the face no way of its own."""
        asked = {
            area: wanted[:, : len(CONTROLS)][:, [c.area == area for c in CONTROLS]].any(axis=0).sum() for area in AREAS
        }
        if asked["lower"] < self._limits.many:
            return ()
        return ("lower", "eyelids") if asked["eyelids"] > 1 else ("lower",)

    def _drawn_back(self, asked: Array, own: Array, columns: Columns, *, fps: float) -> Array:
        """Return rows, (frames, n), drawn back to what the take does until they are within the joint limit of many.

        With b what the take does and a what is asked beyond it, both from the mean face in the whitened space, a frame
        keeps the largest share s of a for which ``|b + s a|`` is within the limit, or no further out than the
        take is within `near_s`.
        """
        mean, whiten, radius = self._prior.ball(columns, self._limits.together)
        radius = max(radius, self._furthest_of(columns, self._limits.together))
        begun, along = (own - mean) @ whiten.T, (asked - own) @ whiten.T
        near = 2 * round(self._limits.near_s * fps) + 1
        furthest = maximum_filter1d(np.linalg.norm(begun, axis=1), near, mode="nearest")
        share = _share_within(begun, along, np.maximum(radius, furthest))
        about = 2 * round(self._limits.about_s * fps) + 1
        share = uniform_filter1d(minimum_filter1d(share, about, mode="nearest"), about, mode="nearest")
        return np.asarray(own + share[:, None] * (asked - own))

    def _within_ball(self, asked: Array, columns: Columns, room: float) -> Array:
        """Return rows, (frames, n), scaled towards the mean face as far as they lie outside the joint limit."""
        mean, whiten, radius = self._prior.ball(columns, self._limits.share)
        reach = np.linalg.norm((asked - mean) @ whiten.T, axis=1)
        limit = np.maximum(_eased_off(reach, radius, room * radius), np.minimum(reach, self._furthest_of(columns, 1.0)))
        scale = limit / np.maximum(reach, 1e-9)
        return np.asarray(mean + scale[:, None] * (asked - mean))

    def _furthest_of(self, columns: Columns, share: float) -> float:
        """Return how far from the mean face a share of the take's frames stays in these controls."""
        key = *columns.tolist(), share
        if key not in self._furthest:
            mean, whiten, _ = self._prior.ball(columns, self._limits.share)
            own = np.linalg.norm((self._controls[:, columns] - mean) @ whiten.T, axis=1)
            self._furthest[key] = float(np.quantile(own, share))
        return self._furthest[key]

    def _without_spikes(self, asked: Array, own: Array, wanted: Mask, pace: tuple[float, float]) -> Array:
        """Return curves that leave their running median no further than was recorded, or than the take does there.

        `pace` is by which factor of what was recorded, and frames a second. One such departure is a gesture; many at the
        same time, in whatever curves, are noise.
        """
        limits, (factor, fps) = self._limits, pace
        steady, fastest = despiked(asked, fps=fps), factor * self._prior.fastest
        departure = asked - steady
        at_once = np.minimum(1.0, np.abs(np.where(wanted, departure, 0.0)) / fastest).sum(axis=1)
        busy = uniform_filter1d(at_once, 2 * round(limits.spell_s * fps / 2) + 1, mode="nearest")
        noise = ease((busy - limits.quick) / (limits.noisy - limits.quick))[:, None]
        usual = np.maximum((1 - noise * (1 - limits.spike)) * fastest, np.abs(own - despiked(own, fps=fps)))
        return np.asarray(steady + np.clip(departure, -usual, usual))


def _share_within(begun: Array, along: Array, radius: Array) -> Array:
    """Return the largest share, (n,) in 0..1, of steps `along`, (n, k), from `begun` that stays within radii, (n,)."""
    across, square = (along * begun).sum(axis=1), (along**2).sum(axis=1)
    left = np.maximum(radius**2 - (begun**2).sum(axis=1), 0.0)
    reach = np.sqrt(across**2 + square * left) - across
    return np.where(square > reach, reach / np.maximum(square, 1e-12), 1.0)


def _eased_off(value: Array, limit: Array | float, room: Array | float) -> Array:
    """Return values that go on as asked up to a limit, and beyond it less and less, by no more than some room.

    With a corner at the limit, a curve that is pulled over it would have one too.
    """
    beyond = np.maximum(value - limit, 0.0)
    return np.asarray(np.minimum(value, limit) + room * np.tanh(beyond / np.maximum(room, 1e-9)))
