"""One function per verb of the user: what the window and the command line call."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from engine import exact
from engine.controls import CONTROLS, bundled_measurer, control_index
from engine.errors import EditError
from engine.take import SHAPES, Array, Take

Change = Literal["set", "add", "scale"]
EYE_SHAPES = np.array([name.startswith("eye") for name in SHAPES])
LOWER_SHAPES = np.array([name.startswith(("jaw", "mouth", "cheekPuff", "noseSneer")) for name in SHAPES])
FREE = {"lower": LOWER_SHAPES, "eyelids": EYE_SHAPES & np.array(["Look" not in name for name in SHAPES])}


@dataclass(frozen=True, eq=False)
class Edit:
    """An edited take and what became of the request.

    Attributes
    ----------
    take : the edited take
    asked, reached : (frames, 8) control curves in mm: what was asked for, and what the new face does
    touched : half-open range of frames whose weights may differ from the original
    """

    take: Take
    asked: Array
    reached: Array
    touched: tuple[int, int]


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
    take: Take, control: str, frames: tuple[int, int], change: Change, amount: float, *, ease_frames: int = 5
) -> Array:
    """Return control curves, (frames, 8) in mm, with one changed over a range and eased in and out beside it."""
    if not np.isfinite(amount):
        raise EditError("The amount of a change must be a finite number.")
    measured = bundled_measurer().measure(take.weights)
    column = control_index(control)
    curve = measured[:, column]
    wanted = {"set": np.full_like(curve, amount), "add": curve + amount, "scale": curve * amount}[change]
    frame = np.arange(len(take))
    away = np.maximum(0, np.maximum(frames[0] - frame, frame - frames[1] + 1)) / (ease_frames + 1)
    weight = np.clip(1 - away, 0, 1)
    weight = weight * weight * (3 - 2 * weight)
    measured[:, column] = np.maximum(0.0, curve + weight * (wanted - curve))
    return measured


def drag_exact(take: Take, asked: Array) -> Edit:
    """Bend the face onto asked control curves, (frames, 8) in mm, moving as little as possible.

    Frames whose controls are asked as they are stay bit-identical. Raises `EditError` for curves of another length.
    """
    measurer = bundled_measurer()
    if asked.shape != (len(take), len(CONTROLS)):
        raise EditError(f"The asked curves have {len(asked)} frames, the take {len(take)}.")
    differs = asked != measurer.measure(take.weights)
    rows, columns = differs.any(axis=1), np.flatnonzero(differs.any(axis=0))
    if not rows.any():
        return Edit(take, asked, measurer.measure(take.weights), (0, 0))
    free = np.logical_or.reduce([FREE[CONTROLS[column].area] for column in columns])
    weights = take.weights.copy()
    weights[rows] = exact.project(weights[rows], asked[rows][:, columns], columns, measurer, free=free)
    touched = np.flatnonzero(rows)
    edited = take.with_weights(weights)
    return Edit(edited, asked, measurer.measure(weights), (int(touched[0]), int(touched[-1]) + 1))
