"""What may be chosen when a take is read: its frame rate, and whose left and right its columns are named by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from engine.errors import EditError

# automatic: by the motion; recorded: mouth and jaw exchanged, as the app does; named: as the columns are called
Sides = Literal["automatic", "recorded", "named"]
SIDES: tuple[Sides, ...] = get_args(Sides)
SIDES_IN_WORDS = {"automatic": "automatic", "recorded": "as the app records", "named": "as named"}
SLOWEST_FPS, FASTEST_FPS = 1.0, 1000.0
NTSC_FPS = (24000 / 1001, 30000 / 1001, 60000 / 1001, 120000 / 1001)  # 23.976, 29.97, 59.94 and 119.88 as people say


@dataclass(frozen=True)
class Reading:
    """How a take is read; what is left out is found out from the file.

    Attributes
    ----------
    fps : frames per second in place of those that its timecodes tell
    sides : whose left and right of mouth and jaw the columns are named by
    """

    fps: float | None = None
    sides: Sides = "automatic"

    def __post_init__(self) -> None:
        if self.fps is not None and not (np.isfinite(self.fps) and SLOWEST_FPS <= self.fps <= FASTEST_FPS):
            raise EditError(f"{self.fps:g} frames per second is not a rate of a take.", "Give a number from 1 to 1000.")
        for exact in NTSC_FPS:
            if self.fps is not None and abs(self.fps - exact) < 0.005:
                object.__setattr__(self, "fps", exact)
        if self.sides not in SIDES:
            raise EditError(
                f"{str(self.sides)[:40]!r} is not a choice of sides.", f"Choose one of: {', '.join(SIDES)}."
            )


AUTOMATIC = Reading()


@dataclass(frozen=True)
class ReadAs:
    """What a reading came to: what was chosen, and the rate and sides that a take has by it.

    Attributes
    ----------
    chosen : the choice
    fps : frames per second
    swapped : whether left and right of mouth and jaw are exchanged, as the app records them
    """

    chosen: Reading
    fps: float
    swapped: bool
