"""Live Link Face over UDP, version 6: all big-endian, names with their lengths before them, then time, then 61 floats."""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np

from engine.live.packet import FALLBACK_FPS, MAX_FPS, ROTATION_COUNT, Drop, Floats, Packet, packet
from engine.take import SHAPES

VERSION = 6
MAX_NAME_BYTES = 256
COUNT = len(SHAPES) + ROTATION_COUNT
_INT = struct.Struct(">i")
_TIME = struct.Struct(">ifii")  # frame number, sub-frame, rate as numerator and denominator
_FLOAT_BYTES = 4

# On the wire left comes before right for jaw and mouth, unlike in the CSV, and the values are where their names say.
_PAIRS = (("jawRight", "jawLeft"), ("mouthRight", "mouthLeft"))
_EXCHANGED = dict(_PAIRS) | {left: right for right, left in _PAIRS}
WIRE_ORDER: tuple[str, ...] = tuple(_EXCHANGED.get(name, name) for name in SHAPES)
_FROM_WIRE = np.array([WIRE_ORDER.index(name) for name in SHAPES])
_NO_ROTATION: Floats = np.zeros(ROTATION_COUNT, np.float32)
_NO_ROTATION.flags.writeable = False


@dataclass(frozen=True)
class Stamp:
    """When a frame was taken: frame number and part of a frame, at a rate."""

    frame: int
    part: float = 0.0
    numerator: int = 60
    denominator: int = 1

    @property
    def fps(self) -> float:
        """The rate; 60 where a sloppy sender names none that can be."""
        rate = self.numerator / self.denominator if self.denominator else 0.0
        return rate if 1.0 <= rate <= MAX_FPS else FALLBACK_FPS


def decode(data: bytes) -> Packet | Drop:
    """Return the frame in a datagram, or why there is none; never raises.

    Lengths are read, not assumed; the shapes' count is absent when the phone sees no face.
    """
    if not data or data[0] != VERSION:
        return Drop.VERSION
    device = _name(data, 1)
    subject = _name(data, device[1]) if device else None
    if subject is None or len(data) < subject[1] + _TIME.size:
        return Drop.LENGTH
    name, at = subject
    stamp = Stamp(*_TIME.unpack_from(data, at))
    time_s = (stamp.frame + stamp.part) / stamp.fps
    at += _TIME.size
    if len(data) == at or (len(data) == at + 1 and data[at] == 0):
        return packet(name, time_s, stamp.fps, None, _NO_ROTATION)
    if data[at] != COUNT:
        return Drop.COUNT
    if len(data) != at + 1 + COUNT * _FLOAT_BYTES:
        return Drop.LENGTH
    values = np.frombuffer(data, ">f4", COUNT, at + 1).astype(np.float32)
    return packet(name, time_s, stamp.fps, values[_FROM_WIRE], values[len(SHAPES) :])


def _name(data: bytes, at: int) -> tuple[str, int] | None:
    """Return a name and the offset behind it; None where its length leads outside the datagram."""
    if len(data) < at + _INT.size:
        return None
    (length,) = _INT.unpack_from(data, at)
    start = at + _INT.size
    if not 0 <= length <= MAX_NAME_BYTES or len(data) < start + length:
        return None
    return data[start : start + length].decode("utf-8", "replace"), start + length


def encode(
    stamp: Stamp, weights: Floats | None, rotations: Floats = _NO_ROTATION, *, subject: str, device: str = "Retake"
) -> bytes:
    """Return the datagram that a phone would send; without weights, one that says that no face is seen."""
    parts = [bytes([VERSION])]
    for name in (device, subject):
        text = name.encode("utf-8")[:MAX_NAME_BYTES]
        parts += [_INT.pack(len(text)), text]
    parts.append(_TIME.pack(stamp.frame, stamp.part, stamp.numerator, stamp.denominator))
    if weights is not None:
        wire = np.empty(COUNT, ">f4")
        wire[_FROM_WIRE] = weights
        wire[len(SHAPES) :] = rotations
        parts += [bytes([COUNT]), wire.tobytes()]
    return b"".join(parts)
