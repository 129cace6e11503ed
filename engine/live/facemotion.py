"""iFacialMocap and Facemotion3d over UDP: text such as `mouthSmile_R-40|eyeBlink_L&3|=head#rx,ry,rz,px,py,pz|` (reported)."""

from __future__ import annotations

import math
import re

import numpy as np

from engine.live.packet import FALLBACK_FPS, ROTATION_COUNT, Drop, Floats, Packet, packet
from engine.take import SHAPE_INDEX, SHAPES

SUBJECT = "iFacialMocap"
MAX_BYTES = 8192
MAX_DEGREES = 3600.0
_WEIGHT = re.compile(r"\|(\w{1,40})[-&](-?\d{1,6})(?=\||\n?\Z)", re.ASCII)
_ROTATION_COLUMNS = {"head": 0, "leftEye": 3, "rightEye": 6}
# Sides are written `_L` and `_R`, or in full.
_COLUMNS = SHAPE_INDEX | {
    f"{name.removesuffix(side)}_{side[0]}": column
    for name, column in SHAPE_INDEX.items()
    for side in ("Left", "Right")
    if name.endswith(side)
}
# The app says pitch, yaw, roll (about x, y, z); ours are yaw, pitch, roll.
_YAW_PITCH_ROLL = (1, 0, 2)


def decode(data: bytes) -> Packet | Drop:
    """Return the frame in a datagram, or why there is none; never raises.

    Entries come in any order; names that we do not know are skipped, shapes that are not named are zero.
    """
    if len(data) > MAX_BYTES:
        return Drop.LENGTH
    try:
        text = data.decode("ascii")
    except UnicodeDecodeError:
        return Drop.TEXT
    rotations = np.zeros(ROTATION_COUNT, np.float32)
    for entry in text.split("|") if "#" in text else ():
        if "#" in entry and not _read_rotation(entry.lstrip("="), rotations):
            return Drop.TEXT
    found = {_COLUMNS[name]: int(percent) for name, percent in _WEIGHT.findall(f"|{text}") if name in _COLUMNS}
    if not found:
        return Drop.TEXT
    weights = np.array([found.get(column, 0) / 100.0 for column in range(len(SHAPES))], np.float32)
    return packet(SUBJECT, None, FALLBACK_FPS, weights, rotations)


def _read_rotation(entry: str, rotations: Floats) -> bool:
    """Write the degrees of `head#rx,ry,rz,...` into (9,) radians; False where they are no numbers."""
    name, _, numbers = entry.partition("#")
    column = _ROTATION_COLUMNS.get(name)
    if column is None:
        return True
    try:
        degrees = [float(number) for number in numbers.split(",")[:3]]
    except ValueError:
        return False
    if len(degrees) != 3 or not all(abs(angle) <= MAX_DEGREES for angle in degrees):
        return False
    rotations[column : column + 3] = [math.radians(degrees[axis]) for axis in _YAW_PITCH_ROLL]
    return True
