"""What a live packet holds, whichever app sent it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
import numpy.typing as npt

from engine.take import SHAPES

Floats = npt.NDArray[np.float32]
ROTATION_COUNT = 9
FALLBACK_FPS = 60.0
MAX_FPS = 1000.0


@dataclass(frozen=True, eq=False)
class Packet:
    """One decoded packet.

    Attributes
    ----------
    subject : the name that the sender gives the face
    time_s : when the frame was taken, on the sender's own clock; None where the format has no clock
    fps : the rate that the sender names
    weights : (52,) float32 in the order of `SHAPES`; None where the phone saw no face
    rotations : (9,) float32, radians; head yaw, pitch, roll, then left eye, then right eye
    """

    subject: str
    time_s: float | None
    fps: float
    weights: Floats | None
    rotations: Floats


class Drop(Enum):
    """Why a datagram is not a frame; counted, never raised."""

    LENGTH = "wrong length"
    VERSION = "not a known format"
    NUMBERS = "numbers that are not finite"
    COUNT = "wrong number of shapes"
    TEXT = "text that makes no sense"


def packet(subject: str, time_s: float | None, fps: float, weights: Floats | None, rotations: Floats) -> Packet | Drop:
    """Return a packet, or a drop where one of its numbers is not finite."""
    if weights is not None and not (np.isfinite(weights).all() and len(weights) == len(SHAPES)):
        return Drop.NUMBERS
    if not np.isfinite(rotations).all() or (time_s is not None and not np.isfinite(time_s)):
        return Drop.NUMBERS
    return Packet(subject, time_s, fps, weights, rotations)
