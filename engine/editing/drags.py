"""Drags: target curves of the face's controls, and the weights that meet them (BSBS19 section 4)."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from engine.controls import ALL_CONTROLS, CONTROLS, bundled_measurer, control_index
from engine.easing import ease
from engine.editing.requests import DEFAULT_BELIEVABILITY, Change
from engine.errors import EditError
from engine.extended import bundled_face
from engine.patch import Patch
from engine.take import SHAPES, Array, Mask, Take
from engine.words import counted

if TYPE_CHECKING:
    from engine.regress.infer import Regressor
    from engine.regress.solve import Stretch

EASE_S = 1 / 6  # over which a change comes and goes beside its frames
FARTHEST_MM = 1000.0  # more than this is a slip; far more would overflow


def ask(
    controls: Array, control: str, frames: tuple[int, int], change: Change, amount: float, *, fps: float
) -> tuple[int, Array]:
    """Return a range's first frame and target curves, (n, 16), that change one control and ease in and out beside it.

    `controls` are the take's measured curves, (frames, 16). Beside the range, its change at the nearer end fades over
    `EASE_S`: a curve that meets the target already stays as it is there too. The range ends where its last frame does, so
    that a take at another rate has the same targets. Raises `EditError` for an amount that no face could take.
    """
    if not abs(amount) <= FARTHEST_MM:
        raise EditError(f"The amount of a change must be a number within {FARTHEST_MM:,.0f}.")
    beside = int(EASE_S * fps)
    first, last = max(0, frames[0] - beside), min(len(controls), frames[1] + beside + 1)
    asked = controls[first:last].copy()
    column = control_index(control)
    curve = asked[:, column]
    target = {"set": np.full_like(curve, amount), "add": curve + amount, "scale": curve * amount}[change]
    frame = np.arange(first, last)
    inside = np.clip(frame, frames[0], min(frames[1], last - 1))
    away = np.abs(frame - inside) / (EASE_S * fps)
    moved = curve + ease(1 - away) * (target - curve)[inside - first]
    asked[:, column] = moved if ALL_CONTROLS[column].signed else np.maximum(0.0, moved)
    return first, asked


class Dragger:
    """Moves a take's control curves to targets (BSBS19 section 4), as often as the pointer moves.

    The result depends on the take and the targets alone (`engine.regress.solve`), not on earlier calls. Only frames with
    a target and a few beside them are computed, whatever the length of the take.

    Parameters
    ----------
    take : what is edited
    controls : its sixteen curves, (frames, 16), if they have been measured already
    asked : targets of earlier edits, (frames, 16), NaN for none, which a drag does not undo
    """

    def __init__(
        self,
        take: Take,
        controls: Array | None = None,
        regressor: Regressor | None = None,
        *,
        asked: Array | None = None,
    ) -> None:
        from engine.regress import infer  # here, since torch takes a second to load
        from engine.regress.solve import Solver

        self.take = take
        whole = controls is not None and controls.shape[1] == len(ALL_CONTROLS)
        self.controls = controls if whole and controls is not None else bundled_face().measure(take.weights)
        self._asked = asked
        self._solver = Solver(take, self.controls, regressor or infer.bundled())

    def drag(self, start: int, asked: Array, *, believability: float = DEFAULT_BELIEVABILITY) -> Patch:
        """Return the patch for target curves over frames from `start`, (n, 16), or (n, 8) without the extended ones.

        `believability` is the plausibility limit: 0 for none, 1 to stay within what this take or the recordings did. NaN,
        or the take's own value, is no target. Raises `EditError`
        for frames that the take does not have.
        """
        stop = start + len(asked)
        if not (0 <= start < stop <= len(self.take)) or asked.shape[1] not in (len(CONTROLS), len(ALL_CONTROLS)):
            raise EditError(
                f"Frames {start}:{stop} are not within the take, which has {counted(len(self.take), 'frame')}."
            )
        if not (np.abs(np.nan_to_num(asked, posinf=np.inf)) < FARTHEST_MM**2).all():
            raise EditError("The asked curves must be finite, and within what a face could be asked.")
        targets = np.full((len(asked), len(ALL_CONTROLS)), np.nan)
        targets[:, : asked.shape[1]] = asked
        stretches = self._solver.stretches(start, targets)
        first = min([start, *(each.start for each in stretches)])
        last = max([stop, *(each.stop for each in stretches)])
        weights, reached = self.take.weights[first:last].copy(), self.controls[first:last].copy()
        target, granted = np.full_like(reached, np.nan), np.full_like(reached, np.nan)
        for each in stretches:
            rows = slice(each.start - first, each.stop - first)
            weights[rows], granted[rows] = self._solver.solve(each, believability=believability, held=self._held(each))
            reached[rows] = bundled_face().measure(weights[rows])
            target[rows] = each.asked
        return Patch(first, weights, target, reached, granted)

    def _held(self, stretch: Stretch) -> Mask | None:
        return None if self._asked is None else ~np.isnan(self._asked[stretch.start : stretch.stop])


@lru_cache(maxsize=1)
def warm_up() -> None:
    """Load the networks and run them once, so that the first drag is as fast as the next.

    They are so small that a second thread costs more than it brings, five times as much on a busy machine.
    """
    import torch

    from engine.regress import infer

    torch.set_num_threads(1)
    infer.bundled().infer(np.tile(bundled_measurer().measure(np.zeros((1, len(SHAPES)))), (64, 1)))
