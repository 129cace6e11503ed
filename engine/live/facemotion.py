"""iFacialMocap and Facemotion3d over UDP: text such as `mouthSmile_R-40|eyeBlink_L&3|=head#rx,ry,rz,px,py,pz|` (reported)."""

from __future__ import annotations

import re

import numpy as np

from engine.live.packet import FALLBACK_FPS, ROTATION_COUNT, Drop, Floats, Packet, packet
from engine.take import SHAPE_INDEX, SHAPES

SUBJECT = "iFacialMocap"
MAX_BYTES = 8192
MAX_DEGREES = 3600.0
_WEIGHT = re.compile(r"^(\w{1,40})[-&](-?\d{1,6})$", re.ASCII)
_ROTATION_COLUMNS = {"head": 0, "leftEye": 3, "rightEye": 6}
# The app says pitch, yaw, roll (about x, y, z); ours are yaw, pitch, roll.
_YAW_PITCH_ROLL = (1, 0, 2)


def decode(data: bytes) -> Packet | Drop:
    """Return the frame in a datagram, or why there is none; never raises.

    Entries come in any order; names that we do not know are skipped, shapes that are not named are zero.
    """
    if len(data) > MAX_BYTES:
        return Drop.LENGTH
    try:
        entries = data.decode("ascii").split("|")
    except UnicodeDecodeError:
        return Drop.TEXT
    weights, rotations, found = np.zeros(len(SHAPES), np.float32), np.zeros(ROTATION_COUNT, np.float32), 0
    for entry in entries:
        if "#" in entry:
            if not _read_rotation(entry.lstrip("="), rotations):
                return Drop.TEXT
        elif match := _WEIGHT.match(entry):
            column = SHAPE_INDEX.get(_full_name(match[1]))
            if column is not None:
                weights[column] = int(match[2]) / 100.0
                found += 1
    return packet(SUBJECT, None, FALLBACK_FPS, weights, rotations) if found else Drop.TEXT


def _full_name(name: str) -> str:
    """Return the ARKit name of a shape that ends on `_L` or `_R`."""
    side = {"_L": "Left", "_R": "Right"}.get(name[-2:])
    return name[:-2] + side if side else name


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
    rotations[column : column + 3] = np.radians(degrees)[list(_YAW_PITCH_ROLL)]
    return True
