"""One function per verb of the user: what the window and the command line call."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import torch
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from engine import exact
from engine.controls import CONTROLS, bundled_measurer, control_index
from engine.easing import ease
from engine.errors import EditError
from engine.models.resample import interpolate
from engine.regress import infer
from engine.regress.network import ALIGNMENT, REACH
from engine.take import MODEL_FPS, SHAPES, Array, Take

Change = Literal["set", "add", "scale"]
EYE_SHAPES = np.array([name.startswith("eye") for name in SHAPES])
LOWER_SHAPES = np.array([name.startswith(("jaw", "mouth", "cheekPuff", "noseSneer")) for name in SHAPES])
FREE = {"lower": LOWER_SHAPES, "eyelids": EYE_SHAPES & np.array(["Look" not in name for name in SHAPES])}
FEATHER_S = 0.5  # how far beyond the changed frames a face may still move, easing into the original
HOLD_S = 0.15  # over which a contact comes and goes
CONTACT_MM, CONTACT_FROM_MM = 1.0, 6.0  # lips or lids asked this close are meant to touch


@dataclass(frozen=True, eq=False)
class Patch:
    """New weights for a range of frames; everything outside stays as it is, bit for bit.

    Attributes
    ----------
    start : first frame
    weights : (frames, 52)
    asked, reached : (frames, 8) control curves in mm: what was asked for, and what the new face does
    """

    start: int
    weights: Array
    asked: Array
    reached: Array

    @property
    def stop(self) -> int:
        """The frame after the last."""
        return self.start + len(self.weights)

    @classmethod
    def between(cls, before: Take, after: Take, frames: tuple[int, int]) -> Patch:
        """Return the patch that turns one take into another over a half-open range; nothing was asked of controls."""
        rows = np.asarray(after.weights[frames[0] : frames[1]])
        if before.weights.shape != after.weights.shape:
            raise EditError(f"The new weights have {len(after)} frames, the take {len(before)}.")
        reached = bundled_measurer().measure(rows)
        return cls(frames[0], rows, reached, reached)

    def apply(self, take: Take) -> Take:
        """Return the take with these weights in place."""
        return take.with_rows(self.start, self.weights)


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

    `controls` are the take's measured curves, (frames, 8). Raises `EditError` for an amount that is not finite.
    """
    if not np.isfinite(amount):
        raise EditError("The amount of a change must be a finite number.")
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
    """

    def __init__(self, take: Take, controls: Array | None = None, regressor: infer.Regressor | None = None) -> None:
        self.take = take
        self.controls = bundled_measurer().measure(take.weights) if controls is None else controls
        self._regressor = regressor or infer.bundled()
        self._known: tuple[tuple[int, int], Array] | None = None

    def drag(self, start: int, asked: Array, *, exact_curve: bool = False) -> Patch:
        """Return the patch for asked curves, (n, 8) in mm, over frames from `start`.

        Contacts are kept: lips or lids asked to touch are made to, as far as weights in range allow; with
        `exact_curve` every asked value is. Raises `EditError` for frames that the take does not have.
        """
        stop = start + len(asked)
        if not (0 <= start < stop <= len(self.take)) or asked.shape[1] != len(CONTROLS):
            raise EditError(f"Frames {start}:{stop} are not within the take, which has {len(self.take)} frames.")
        if not np.isfinite(asked).all():
            raise EditError("The asked curves must be finite.")
        feather = round(FEATHER_S * self.take.fps)
        first, last = max(0, start - feather), min(len(self.take), stop + feather)
        wanted = self.controls[first:last].copy()
        wanted[start - first : stop - first] = asked
        changed = (wanted != self.controls[first:last]).any(axis=1)
        weights = self.take.weights[first:last].copy()
        if changed.any():
            weights = self._composite(weights, wanted, first, changed)
            weights = _land(weights, self.controls[first:last], wanted, fps=self.take.fps, exact_curve=exact_curve)
        return Patch(first, weights, wanted, bundled_measurer().measure(weights))

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
        kept = interpolate(self.take.weights[seen_from:seen_to], at)
        rows = start - low, stop - low
        if self._known is None or self._known[0] != (start, stop):
            self._known = ((start, stop), self._regressor.infer_range(interpolate(original, at), *rows, kept=kept))
        made = self._regressor.infer_range(interpolate(edited, at), *rows, kept=kept)
        return interpolate(made - self._known[1], np.arange(first, last, dtype=np.float64) * per_frame - start)


def _eased_in_time(hold: Array, *, frames: int) -> Array:
    """Let what holds at a frame, (frames, n), come and go over the frames beside it, and hold no less there."""
    window = 2 * frames + 1
    return np.asarray(uniform_filter1d(maximum_filter1d(hold, window, axis=0), window, axis=0))


def _land(weights: Array, measured: Array, wanted: Array, *, fps: float, exact_curve: bool) -> Array:
    """Project frames onto the asked values that must be met, one area of the face at a time.

    A contact takes hold gradually, as the asked distance gets small and over time; else the lips would pop shut.
    """
    measurer = bundled_measurer()
    for area, free in FREE.items():
        columns = np.array([index for index, control in enumerate(CONTROLS) if control.area == area])
        moved = wanted[:, columns] != measured[:, columns]
        hold = ease((CONTACT_FROM_MM - wanted[:, columns]) / (CONTACT_FROM_MM - CONTACT_MM))
        share = moved * (1.0 if exact_curve else _eased_in_time(hold * moved, frames=round(HOLD_S * fps)))
        columns, share = columns[share.any(axis=0)], share[:, share.any(axis=0)]
        rows = share.any(axis=1)
        if rows.any():
            now = measurer.measure(weights[rows])[:, columns]
            target = now + share[rows] * (wanted[rows][:, columns] - now)
            weights = weights.copy()
            weights[rows] = exact.project(weights[rows], target, columns, measurer, free=free)
    return weights


def edit_control(
    take: Take, control: str, frames: tuple[int, int], change: Change, amount: float, *, exact_curve: bool = False
) -> Patch:
    """Change one control over a range of frames and bend the face after it; the verb behind `retake edit`."""
    dragger = Dragger(take)
    return dragger.drag(*ask(dragger.controls, control, frames, change, amount), exact_curve=exact_curve)


@lru_cache(maxsize=1)
def warm_up() -> None:
    """Load the networks and run them once, so that the first drag is as fast as the next.

    They are so small that a second thread costs more than it brings, five times as much on a busy machine.
    """
    torch.set_num_threads(1)
    infer.bundled().infer(np.tile(bundled_measurer().measure(np.zeros((1, len(SHAPES)))), (64, 1)))
