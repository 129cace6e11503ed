"""Any datagram to a frame or a counted drop, whichever app sent it."""

from __future__ import annotations

from engine.live import facemotion, livelink
from engine.live.packet import Drop, Packet

MAX_DATAGRAM = 65536  # nothing that UDP can carry is cut short; a cut name would be read as another subject


def decode(data: bytes) -> Packet | Drop:
    """Return the frame in a datagram, or why there is none; never raises. Live Link Face begins with its version."""
    if data[:1] == bytes([livelink.VERSION]):
        return livelink.decode(data)
    if data[:1].isalpha() or data[:1] == b"=":
        return facemotion.decode(data)
    return Drop.VERSION
