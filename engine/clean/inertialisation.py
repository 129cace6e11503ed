"""Inertialisation after a lost run: the jump to the returning face decays on a critically damped spring (Bollo 2018).

The estimate may jump to the returning face at once; the output starts where the extrapolation ended, with its velocity,
and joins the estimate. The spring's closed form makes it independent of the frame rate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Tuning:
    """Decay of the offset; ranges tried were not recorded."""

    half_life_s: float = 0.06  # seconds, after a long gap
    half_life_per_gap: float = 0.25  # share of the gap's length, after a short one: hides a single lost packet
    negligible: float = 1e-6  # weight, and weight per second, at which the offset is set to zero


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class Inertialisation:
    """The offset of the output from the estimate, which decays after a lost run.

    Attributes
    ----------
    offset : (52,) float32, weight
    velocity : (52,) float32, weight per second
    half_life_s : of the current decay
    gap_s : seconds for which the face has been lost
    """

    offset: Floats
    velocity: Floats
    half_life_s: float = TUNING.half_life_s
    gap_s: float = 0.0


def no_offset(shapes: int) -> Inertialisation:
    """Return an offset of zero for so many shapes."""
    zero = np.zeros(shapes, np.float32)
    return Inertialisation(zero, zero)


def advance(state: Inertialisation, jump: Floats, velocity: Floats, step_s: float, *, present: bool) -> Inertialisation:
    """Advance the offset by one frame; the frame that ends a gap adds the estimate's jump and velocity to it.

    Parameters
    ----------
    jump : (52,) how far the estimate moved in this frame
    velocity : (52,) of the estimate on the frame before, per second
    present : whether the tracker had a face in this frame
    """
    if not present:
        return _decay(state, step_s, state.gap_s + step_s)
    if state.gap_s:
        half_life_s = min(TUNING.half_life_s, TUNING.half_life_per_gap * state.gap_s)
        offset, speed = state.offset - jump, state.velocity + velocity
        state = Inertialisation(offset, speed, max(half_life_s, state.half_life_s if state.offset.any() else 0.0))
    return _decay(state, step_s, 0.0)


def _decay(state: Inertialisation, step_s: float, gap_s: float) -> Inertialisation:
    """Decay the offset for one step, by the exact solution ``exp(-k t) (x + (v + k x) t)`` of the spring."""
    if not (state.offset.any() or state.velocity.any()):
        return Inertialisation(state.offset, state.velocity, state.half_life_s, gap_s)
    stiffness = np.float32(2 * np.log(2) / state.half_life_s)
    step = np.float32(step_s)
    pull = state.velocity + state.offset * stiffness
    fade = np.exp(-stiffness * step)
    offset, velocity = fade * (state.offset + pull * step), fade * (state.velocity - pull * stiffness * step)
    over = max(float(np.abs(offset).max()), float(np.abs(velocity).max())) < TUNING.negligible
    if over:
        return Inertialisation(np.zeros_like(offset), np.zeros_like(offset), state.half_life_s, gap_s)
    return Inertialisation(offset, velocity, state.half_life_s, gap_s)
