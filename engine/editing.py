"""One function per verb of the user: what the window and the command line call."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import torch
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from engine import exact
from engine.controls import CONTROL_INDEX, CONTROLS, bundled_measurer, control_index
from engine.easing import ease
from engine.errors import EditError
from engine.models.resample import interpolate
from engine.regress import infer
from engine.regress.network import ALIGNMENT, REACH
from engine.take import MODEL_FPS, SHAPES, Array, Mask, Take

Change = Literal["set", "add", "scale"]
# The smallest change that closes lips is mouthClose over an open jaw, which nobody does.
GUESSED = exact.FREE | {"lower": exact.FREE["lower"] & np.array([name != "mouthClose" for name in SHAPES])}
RIGHT_CONTROLS, LEFT_CONTROLS = (
    [index for index, control in enumerate(CONTROLS) if control.name.endswith(side)] for side in ("right", "left")
)
_ONE_WAY = ("jawRight", "jawLeft", "mouthRight", "mouthLeft")  # directions of the whole mouth, not sides of the face
RIGHT_SHAPES, LEFT_SHAPES = (
    np.array([name.endswith(side) and name not in _ONE_WAY for name in SHAPES]) for side in ("Right", "Left")
)
_SIDEWAYS = [CONTROL_INDEX[name] for name in ("lips_horizontal", "corner_right", "corner_left")]
_UPRIGHT = [CONTROL_INDEX[name] for name in ("lips_vertical", "nose_to_lip", "chin_to_lip")]
_LIDS = [CONTROL_INDEX[name] for name in ("eyelid_right", "eyelid_left")]
FEATHER_S = 0.5  # how far beyond the changed frames a face may still move, easing into the original
FOLLOW = True  # on validation takes edits miss 0.96 mm so, 1.89 mm without; 1.07 times as far from recorded motion
FOLLOW_ROUNDS = 6  # of landing; the guess need not be exact
ALIKE_MM = 0.5  # sides asked to change as equally as this are asked together
FARTHEST_MM = 1000.0  # more than this is a slip; far more would overflow
HOLD_S = 0.15  # over which a contact comes and goes
CONTACT_MM, CONTACT_FROM_MM = 1.0, 6.0  # lips or lids asked this close are meant to touch


@dataclass(frozen=True, eq=False)
class Patch:
    """New weights for a range of frames; everything outside stays as it is, bit for bit, but for lost frames beside it.

    Attributes
    ----------
    start : first frame
    weights : (frames, 52)
    asked, reached : (frames, 8) control curves in mm: what was asked for, and what the new face does
    lost : (frames,) bool, the frames that are lost from now on; None leaves it to `Take.with_rows`
    """

    start: int
    weights: Array
    asked: Array
    reached: Array
    lost: Mask | None = None

    @property
    def stop(self) -> int:
        """The frame after the last."""
        return self.start + len(self.weights)

    @classmethod
    def between(cls, before: Take, after: Take, frames: tuple[int, int]) -> Patch:
        """Return the patch that turns one take into another over a half-open range; nothing was asked of controls.

        The range is grown over the lost frames beside it, which follow what changed.
        """
        if before.weights.shape != after.weights.shape:
            raise EditError(f"The new weights have {len(after)} frames, the take {len(before)}.")
        first, last = before.with_lost_beside(*frames)
        rows = np.asarray(after.weights[first:last])
        reached = bundled_measurer().measure(rows)
        return cls(first, rows, reached, reached, after.lost[first:last])

    def apply(self, take: Take) -> Take:
        """Return the take with these weights in place."""
        if self.lost is None:
            return take.with_rows(self.start, self.weights)
        return take.with_exact_rows(self.start, self.weights, self.lost)

    def settled(self, take: Take) -> Patch:
        """Return the patch over every frame of a take that it changes, which says of each whether it is lost."""
        if self.lost is not None:
            return self
        whole = Patch.between(take, self.apply(take), (self.start, self.stop))
        asked, reached = whole.asked.copy(), whole.reached.copy()
        inside = slice(self.start - whole.start, self.stop - whole.start)
        same = (whole.weights[inside] == self.weights).all(axis=1)[:, None]
        asked[inside] = np.where(same, self.asked, asked[inside])
        reached[inside] = np.where(same, self.reached, reached[inside])
        return Patch(whole.start, whole.weights, asked, reached, whole.lost)


def parse_frames(text: str, take: Take) -> tuple[int, int]:
    """Return the half-open range that `A:B` names; raises `EditError` when it is not within the take."""
    try:
        start, stop = (int(part) for part in text.split(":"))
    except ValueError:
        raise EditError(
            f"{text!r} is not a range of frames.", "Write the first frame and the one after the last: 40:60."
        ) from None
    if not 0 <= start < stop <= len(take):
        raise EditError(f"Frames {start}:{stop} are not within the take, which has {len(take)} frames.")
    return start, stop


def ask(
    controls: Array, control: str, frames: tuple[int, int], change: Change, amount: float, *, ease_frames: int = 5
) -> tuple[int, Array]:
    """Return a range's first frame and asked curves, (n, 8) in mm: one control changed, eased in and out beside it.

    `controls` are the take's measured curves, (frames, 8). Raises `EditError` for an amount that no face could take.
    """
    if not abs(amount) <= FARTHEST_MM:
        raise EditError(f"The amount of a change must be a number within {FARTHEST_MM:,.0f}.")
    first, last = max(0, frames[0] - ease_frames), min(len(controls), frames[1] + ease_frames)
    asked = controls[first:last].copy()
    column = control_index(control)
    curve = asked[:, column]
    wanted = {"set": np.full_like(curve, amount), "add": curve + amount, "scale": curve * amount}[change]
    frame = np.arange(first, last)
    away = np.maximum(0, np.maximum(frames[0] - frame, frame - frames[1] + 1)) / (ease_frames + 1)
    asked[:, column] = np.maximum(0.0, curve + ease(1 - away) * (wanted - curve))
    return first, asked


class Dragger:
    """Bends one take by its control curves (BSBS19 section 4), as often as the pointer moves.

    New weights are ``original + N(asked) - N(original)``, N = autoencoder after regressor, so what the networks cannot
    see of a performance survives. N runs over the window that the change can reach and no further, whatever the length
    of the take; N(original) is kept while the same window is dragged.

    Parameters
    ----------
    take : what is edited
    controls : its curves, (frames, 8) mm, if they have been measured already
    asked : what edits before have asked of them, likewise, NaN where nothing; what was asked once is not undone
    """

    def __init__(
        self,
        take: Take,
        controls: Array | None = None,
        regressor: infer.Regressor | None = None,
        *,
        asked: Array | None = None,
    ) -> None:
        self.take = take
        self.controls = bundled_measurer().measure(take.weights) if controls is None else controls
        self._held: Mask = np.zeros(self.controls.shape, bool) if asked is None else ~np.isnan(asked)
        self._regressor = regressor or infer.bundled()
        self._known: dict[str, Array] = {}
        self._answers = infer.Answers()
        self._known_frames: tuple[int, int] | None = None

    def drag(self, start: int, asked: Array, *, exact_curve: bool = False, follow: bool = FOLLOW) -> Patch:
        """Return the patch for asked curves, (n, 8) in mm, over frames from `start`.

        Contacts are kept: lips or lids asked to touch are made to, as far as weights in range allow; with
        `exact_curve` every asked value is. Controls of which nothing was ever asked are put to the networks as they
        come out of the smallest change that reaches what is asked; without `follow`, as the take has them. Raises
        `EditError` for frames that the take does not have.
        """
        stop = start + len(asked)
        if not (0 <= start < stop <= len(self.take)) or asked.shape[1] != len(CONTROLS):
            raise EditError(f"Frames {start}:{stop} are not within the take, which has {len(self.take)} frames.")
        if not (np.abs(asked) < FARTHEST_MM**2).all():
            raise EditError("The asked curves must be finite, and within what a face could be asked.")
        feather = round(FEATHER_S * self.take.fps)
        first, last = max(0, start - feather), min(len(self.take), stop + feather)
        wanted = self.controls[first:last].copy()
        wanted[start - first : stop - first] = asked
        moved = wanted != self.controls[first:last]
        original = weights = self.take.weights[first:last].copy()
        if moved.any():
            held = moved | (self._held[first:last] & moved.any(axis=1, keepdims=True))
            share = _contact(wanted, moved | _kept_together(moved), fps=self.take.fps)
            fed = _followed(original, self._within_reach(wanted, first), held) if follow else wanted
            weights = self._composite(original, fed + share * (wanted - fed), first, moved.any(axis=1))
            weights = _land(weights, wanted, np.maximum(share, held) if exact_curve else share)
        return Patch(first, weights, wanted, bundled_measurer().measure(weights))

    def _within_reach(self, wanted: Array, first: int) -> Array:
        """Return curves no further than people or the take went: what follows beyond that would bring the face back."""
        own, (low, high) = self.controls[first : first + len(wanted)], self._regressor.limits
        return np.clip(wanted, np.minimum(own, low), np.maximum(own, high))

    def _composite(self, weights: Array, wanted: Array, first: int, changed: np.ndarray) -> Array:
        change = self._change(wanted, first)
        touched = np.flatnonzero(changed)
        frame = np.arange(len(weights))
        away = np.maximum(0, np.maximum(touched[0] - frame, frame - touched[-1])) / (FEATHER_S * self.take.fps + 1)
        share = ease(1 - away)[:, None]
        moved = np.clip(weights + share * change, np.minimum(weights, 0.0), np.maximum(weights, 1.0))
        return np.where(share > 0, moved, weights)

    def _change(self, wanted: Array, first: int) -> Array:
        """Return N(asked) - N(original) at the take's own frames, (n, 52)."""
        last = first + len(wanted)
        per_frame = MODEL_FPS / self.take.fps
        model_frames = int(np.ceil((len(self.take) - 1) * per_frame)) + 1
        start, stop = int(first * per_frame), min(model_frames, int(np.ceil((last - 1) * per_frame)) + 1)
        low = max(0, (start - REACH) // ALIGNMENT * ALIGNMENT)
        high = min(model_frames, -(-(stop + REACH) // ALIGNMENT) * ALIGNMENT)
        seen_from = int(low / per_frame)
        seen_to = min(len(self.take), int(np.ceil((high - 1) / per_frame)) + 2)
        original = self.controls[seen_from:seen_to]
        edited = original.copy()
        edited[first - seen_from : last - seen_from] = wanted
        at = np.arange(low, high, dtype=np.float64) / per_frame - seen_from
        change = self._difference(interpolate(original, at), interpolate(edited, at), (start, stop), low)
        return interpolate(change, np.arange(first, last, dtype=np.float64) * per_frame - start)

    def _difference(self, original: Array, edited: Array, frames: tuple[int, int], low: int) -> Array:
        """Return N(edited) - N(original) for model frames; the curves begin at `low`.

        Where the sides of the face are asked for different changes, each makes its own as a face would that is alike on
        both: so the recorded ones are, and networks trained on them let the left eye blink with the right.
        """
        moved = edited - original
        if np.abs(moved[:, RIGHT_CONTROLS] - moved[:, LEFT_CONTROLS]).max() <= ALIKE_MM:
            before = self._once("", original, frames, low)
            return self._made(edited, original, frames, low) - before
        changes = []
        for side, columns in (("right", RIGHT_CONTROLS), ("left", LEFT_CONTROLS)):
            before, after = _alike(original, columns), _alike(edited, columns)
            same = np.allclose(before, after, rtol=0, atol=1e-6)
            changes.append(
                0.0 if same else self._made(after, before, frames, low) - self._once(side, before, frames, low)
            )
        right, left = changes
        return np.where(RIGHT_SHAPES, right, np.where(LEFT_SHAPES, left, (np.asarray(right) + left) / 2))

    def _made(
        self, curves: Array, original: Array, frames: tuple[int, int], low: int, *, remember: bool = False
    ) -> Array:
        return self._regressor.infer_range(
            curves, frames[0] - low, frames[1] - low, original=original, answers=self._answers, remember=remember
        )

    def _once(self, what: str, curves: Array, frames: tuple[int, int], low: int) -> Array:
        """Return N of curves that stay the same while the same window is dragged."""
        if self._known_frames != frames:
            self._known, self._known_frames, self._answers = {}, frames, infer.Answers()
        if what not in self._known:
            self._known[what] = self._made(curves, curves, frames, low, remember=True)
        return self._known[what]


def _alike(curves: Array, columns: list[int]) -> Array:
    """Return control curves, (frames, 8), whose sides are both as the one that has these columns."""
    alike = curves.copy()
    alike[:, RIGHT_CONTROLS] = alike[:, LEFT_CONTROLS] = curves[:, columns]
    return alike


def _eased_in_time(hold: Array, *, frames: int) -> Array:
    """Let what holds at a frame, (frames, n), come and go over the frames beside it, and hold no less there."""
    window = 2 * frames + 1
    return np.asarray(uniform_filter1d(maximum_filter1d(hold, window, axis=0), window, axis=0))


def _contact(wanted: Array, moved: Mask, *, fps: float) -> Array:
    """Return how firmly asked values, (frames, 8) in mm, are held, 0 to 1, so that lips and lids asked to touch do.

    A contact takes hold gradually, as the asked distance gets small and over time; else the lips would pop shut.
    """
    hold = ease((CONTACT_FROM_MM - wanted) / (CONTACT_FROM_MM - CONTACT_MM))
    return _eased_in_time(hold * moved, frames=round(HOLD_S * fps)) * moved


def _kept_together(moved: Mask) -> Mask:
    """Return where lips that touch shall go on to, (frames, 8): what moves corners alone says nothing of parting them."""
    sideways = moved[:, _SIDEWAYS].any(axis=1) & ~moved[:, _UPRIGHT].any(axis=1)
    kept: Mask = np.zeros(moved.shape, bool)
    kept[sideways, CONTROL_INDEX["lips_vertical"]] = True
    return kept


def _followed(weights: Array, wanted: Array, held: Mask) -> Array:
    """Return curves, (frames, 8) in mm, with the values that are not `held` as the held ones bring them about."""
    if not held[:, [*_SIDEWAYS, *_UPRIGHT]].any():
        return wanted  # one lid says nothing of the other
    guess = _land(weights, wanted, held.astype(float), free=GUESSED, rounds=FOLLOW_ROUNDS)
    follows = ~held
    follows[:, _LIDS] = False  # nor does the mouth say anything of the lids
    return np.where(follows, bundled_measurer().measure(guess), wanted)


def _land(
    weights: Array, wanted: Array, share: Array, *, free: Mapping[str, Mask] = exact.FREE, rounds: int = exact.ROUNDS
) -> Array:
    """Bring frames, (frames, 52), towards asked values by a share, (frames, 8) of 0 to 1, one area after another."""
    measurer = bundled_measurer()
    landed = weights.copy()
    for area, movable in free.items():
        columns = np.array([index for index, control in enumerate(CONTROLS) if control.area == area])
        columns = columns[share[:, columns].any(axis=0)]
        rows = share[:, columns].any(axis=1)
        if rows.any():
            now = measurer.measure(landed[rows])[:, columns]
            target = now + share[rows][:, columns] * (wanted[rows][:, columns] - now)
            landed[rows] = exact.project(landed[rows], target, columns, measurer, free=movable, rounds=rounds)
    return landed


def edit_control(
    take: Take,
    control: str,
    frames: tuple[int, int],
    change: Change,
    amount: float,
    *,
    exact_curve: bool = False,
    follow: bool = FOLLOW,
) -> Patch:
    """Change one control over a range of frames and bend the face after it; the verb behind `retake edit`."""
    dragger = Dragger(take)
    start, asked = ask(dragger.controls, control, frames, change, amount)
    return dragger.drag(start, asked, exact_curve=exact_curve, follow=follow)


@lru_cache(maxsize=1)
def warm_up() -> None:
    """Load the networks and run them once, so that the first drag is as fast as the next.

    They are so small that a second thread costs more than it brings, five times as much on a busy machine.
    """
    torch.set_num_threads(1)
    infer.bundled().infer(np.tile(bundled_measurer().measure(np.zeros((1, len(SHAPES)))), (64, 1)))
