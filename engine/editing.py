"""One function per verb of the user: what the window and the command line call."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import torch

from engine.controls import ALL_CONTROLS, CONTROLS, bundled_measurer, control_index
from engine.easing import ease
from engine.errors import EditError
from engine.extended import bundled_face
from engine.regress import infer
from engine.regress.plausibility import DEFAULT_BELIEVABILITY
from engine.regress.solve import Solver, Stretch
from engine.take import SHAPES, Array, Mask, Take
from engine.words import counted

Change = Literal["set", "add", "scale"]
EASE_S = 1 / 6  # over which a change comes and goes beside its frames
FARTHEST_MM = 1000.0  # more than this is a slip; far more would overflow


@dataclass(frozen=True, eq=False)
class Patch:
    """New weights for a range of frames; everything outside stays as it is, bit for bit, but for lost frames beside it.

    Attributes
    ----------
    start : first frame
    weights : (frames, 52)
    asked : (frames, 16) control curves that were asked for, NaN where nothing was
    reached : (frames, 16) what the new face does
    granted : (frames, 16) what was asked as far as it is believable; None where nobody asked for a curve
    lost : (frames,) bool, the frames that are lost from now on; None leaves it to `Take.with_rows`
    """

    start: int
    weights: Array
    asked: Array
    reached: Array
    granted: Array | None = None
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
            raise EditError(f"The new weights have {counted(len(after), 'frame')}, the take {len(before)}.")
        first, last = before.with_lost_beside(*frames)
        rows = np.asarray(after.weights[first:last])
        reached = bundled_face().measure(rows)
        return cls(first, rows, np.full_like(reached, np.nan), reached, lost=after.lost[first:last])

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
        granted = None
        if self.granted is not None:
            granted = np.full_like(asked, np.nan)
            granted[inside] = self.granted
        return Patch(whole.start, whole.weights, asked, reached, granted, whole.lost)


def parse_frames(text: str, take: Take) -> tuple[int, int]:
    """Return the half-open range that `A:B` names; raises `EditError` when it is not within the take."""
    try:
        start, stop = (int(part) for part in text.split(":"))
    except ValueError:
        raise EditError(
            f"{text!r} is not a range of frames.", "Write the first frame and the one after the last: 40:60."
        ) from None
    if not 0 <= start < stop <= len(take):
        raise EditError(f"Frames {start}:{stop} are not within the take, which has {counted(len(take), 'frame')}.")
    return start, stop


def ask(
    controls: Array, control: str, frames: tuple[int, int], change: Change, amount: float, *, fps: float
) -> tuple[int, Array]:
    """Return a range's first frame and asked curves, (n, 16): one control changed, and beside it eased in and out.

    `controls` are the take's measured curves, (frames, 16). Beside the range, its change at the nearer end fades over
    `EASE_S`: a curve that is already as asked stays as it is there too. The range ends where its last frame does, so
    that a take at another rate is asked the same. Raises `EditError` for an amount that no face could take.
    """
    if not abs(amount) <= FARTHEST_MM:
        raise EditError(f"The amount of a change must be a number within {FARTHEST_MM:,.0f}.")
    beside = int(EASE_S * fps)
    first, last = max(0, frames[0] - beside), min(len(controls), frames[1] + beside + 1)
    asked = controls[first:last].copy()
    column = control_index(control)
    curve = asked[:, column]
    wanted = {"set": np.full_like(curve, amount), "add": curve + amount, "scale": curve * amount}[change]
    frame = np.arange(first, last)
    inside = np.clip(frame, frames[0], min(frames[1], last - 1))
    away = np.abs(frame - inside) / (EASE_S * fps)
    bent = curve + ease(1 - away) * (wanted - curve)[inside - first]
    asked[:, column] = bent if ALL_CONTROLS[column].signed else np.maximum(0.0, bent)
    return first, asked


class Dragger:
    """Bends one take by its control curves (BSBS19 section 4), as often as the pointer moves.

    What the face becomes is a function of the take and of what is asked alone (`engine.regress.solve`), whatever was
    asked on the way. Only the frames that are asked for, and a few beside them, are looked at, whatever the length of
    the take.

    Parameters
    ----------
    take : what is edited
    controls : its sixteen curves, (frames, 16), if they have been measured already
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
        whole = controls is not None and controls.shape[1] == len(ALL_CONTROLS)
        self.controls = controls if whole and controls is not None else bundled_face().measure(take.weights)
        self._asked = asked
        self._solver = Solver(take, self.controls, regressor or infer.bundled())

    def drag(self, start: int, asked: Array, *, believability: float = DEFAULT_BELIEVABILITY) -> Patch:
        """Return the patch for asked curves over frames from `start`, (n, 16), or (n, 8) without the extended ones.

        `believability` is 0 where the face shall go wherever the curves are pulled, 1 where it shall do nothing that
        neither this take nor the recordings did. What is asked as it is, or is NaN, is not asked. Raises `EditError`
        for frames that the take does not have.
        """
        stop = start + len(asked)
        if not (0 <= start < stop <= len(self.take)) or asked.shape[1] not in (len(CONTROLS), len(ALL_CONTROLS)):
            raise EditError(
                f"Frames {start}:{stop} are not within the take, which has {counted(len(self.take), 'frame')}."
            )
        if not (np.abs(np.nan_to_num(asked, posinf=np.inf)) < FARTHEST_MM**2).all():
            raise EditError("The asked curves must be finite, and within what a face could be asked.")
        wish = np.full((len(asked), len(ALL_CONTROLS)), np.nan)
        wish[:, : asked.shape[1]] = asked
        stretches = self._solver.stretches(start, wish)
        first = min([start, *(each.start for each in stretches)])
        last = max([stop, *(each.stop for each in stretches)])
        weights, reached = self.take.weights[first:last].copy(), self.controls[first:last].copy()
        wanted, granted = np.full_like(reached, np.nan), np.full_like(reached, np.nan)
        for each in stretches:
            rows = slice(each.start - first, each.stop - first)
            weights[rows], granted[rows] = self._solver.solve(each, believability=believability, held=self._held(each))
            reached[rows] = bundled_face().measure(weights[rows])
            wanted[rows] = each.asked
        return Patch(first, weights, wanted, reached, granted)

    def _held(self, stretch: Stretch) -> Mask | None:
        return None if self._asked is None else ~np.isnan(self._asked[stretch.start : stretch.stop])


def edit_control(
    take: Take,
    control: str,
    frames: tuple[int, int],
    change: Change,
    amount: float,
    *,
    believability: float = DEFAULT_BELIEVABILITY,
) -> Patch:
    """Change one control over a range of frames and bend the face after it; the verb behind `retake edit`."""
    dragger = Dragger(take)
    start, asked = ask(dragger.controls, control, frames, change, amount, fps=take.fps)
    return dragger.drag(start, asked, believability=believability)


@lru_cache(maxsize=1)
def warm_up() -> None:
    """Load the networks and run them once, so that the first drag is as fast as the next.

    They are so small that a second thread costs more than it brings, five times as much on a busy machine.
    """
    torch.set_num_threads(1)
    infer.bundled().infer(np.tile(bundled_measurer().measure(np.zeros((1, len(SHAPES)))), (64, 1)))
