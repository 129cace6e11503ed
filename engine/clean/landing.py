"""Coming back from a lost run without a pop: the difference dies away on a critically damped spring.

After a gap the estimate is free to be right at once; what is shown sets out from where the bridge had led, with its
speed, and joins the estimate (inertialisation: Bollo 2018; the spring's closed form makes it independent of the rate).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]
HALF_LIFE_S = 0.06  # of the difference after a long gap
HALF_LIFE_PER_GAP = 0.25  # and of the gap's own length after a short one: a single lost packet must not be felt


@dataclass(frozen=True, eq=False)
class Landing:
    """The difference between what is shown and the estimate.

    Attributes
    ----------
    offset : (52,) float32, weight
    velocity : (52,) float32, weight per second
    half_life_s : of the landing under way
    gap_s : for how long the face has been lost
    """

    offset: Floats
    velocity: Floats
    half_life_s: float = HALF_LIFE_S
    gap_s: float = 0.0


def still(shapes: int) -> Landing:
    """Return no difference at all."""
    nothing = np.zeros(shapes, np.float32)
    return Landing(nothing, nothing)


def advance(landing: Landing, jump: Floats, velocity: Floats, step_s: float, *, present: bool) -> Landing:
    """Move on by one frame.

    Parameters
    ----------
    jump : (52,) how far the estimate moved in this frame
    velocity : (52,) of the estimate on the frame before, per second
    present : whether the tracker had a face in this frame
    """
    if not present:
        return _sprung(landing, step_s, landing.gap_s + step_s)
    if landing.gap_s:
        half_life_s = min(HALF_LIFE_S, HALF_LIFE_PER_GAP * landing.gap_s)
        offset, speed = landing.offset - jump, landing.velocity + velocity
        landing = Landing(offset, speed, max(half_life_s, landing.half_life_s if landing.offset.any() else 0.0))
    return _sprung(landing, step_s, 0.0)


def _sprung(landing: Landing, step_s: float, gap_s: float) -> Landing:
    """Let the spring work for one step: the exact solution of a critically damped one."""
    if not (landing.offset.any() or landing.velocity.any()):
        return Landing(landing.offset, landing.velocity, landing.half_life_s, gap_s)
    stiffness = np.float32(2 * np.log(2) / landing.half_life_s)
    step = np.float32(step_s)
    pull = landing.velocity + landing.offset * stiffness
    fade = np.exp(-stiffness * step)
    offset, velocity = fade * (landing.offset + pull * step), fade * (landing.velocity - pull * stiffness * step)
    over = max(float(np.abs(offset).max()), float(np.abs(velocity).max())) < 1e-6
    if over:
        return Landing(np.zeros_like(offset), np.zeros_like(offset), landing.half_life_s, gap_s)
    return Landing(offset, velocity, landing.half_life_s, gap_s)
