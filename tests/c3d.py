"""C3D files for tests, written byte by byte: with floats or scaled whole numbers, as Intel or DEC machines write them."""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np

INTEL, DEC = 84, 85


def c3d(
    positions: np.ndarray,
    names: Sequence[str],
    *,
    processor: int = INTEL,
    scale: float = -1.0,
    rate: float = 60.0,
    unit: str = "mm",
    long_frames: int = 0,
) -> bytes:
    """Return a file of positions, (frames, n, 3); where scale is above zero they are whole numbers of so much."""
    frames, points = positions.shape[:2]
    values = np.zeros((frames, points, 4))
    values[..., :3] = positions if scale < 0 else np.round(positions / scale)
    seen = np.isfinite(positions).all(axis=2)
    values[~seen] = (0, 0, 0, -1)
    width = max(map(len, names))

    def number(value: float) -> bytes:
        return _floats(np.array([value]), processor)

    def parameter(name: str, kind: int, shape: bytes, data: bytes) -> bytes:
        body = struct.pack("<bB", kind, len(shape)) + shape + data + b"\0"
        return struct.pack("<bb", len(name), 1) + name.encode() + struct.pack("<h", len(body) + 2) + body

    entries = struct.pack("<bb", 5, -1) + b"POINT" + struct.pack("<h", 3) + b"\0"
    entries += parameter("USED", 2, b"", struct.pack("<H", points))
    entries += parameter("RATE", 4, b"", number(rate)) + parameter("SCALE", 4, b"", number(scale))
    labels = b"".join(name.encode().ljust(width) for name in names)
    entries += parameter("LABELS", -1, bytes((width, len(names))), labels)
    entries += parameter("UNITS", -1, bytes((len(unit),)), unit.encode())
    if long_frames:
        entries += parameter("LONG_FRAMES", 4, b"", number(long_frames))
    blocks = -(-(len(entries) + 6) // 512)
    last = min(frames, 65535) if not long_frames else 1
    head = struct.pack("<BBHHHHH", 2, 0x50, points, 0, 1, last, 0) + number(scale)
    head += struct.pack("<HH", 2 + blocks, 0) + number(rate)
    data = _floats(values.reshape(-1), processor) if scale < 0 else values.reshape(-1).astype("<i2").tobytes()
    middle = (bytes((1, 0x50, blocks, processor)) + entries + b"\0\0").ljust(512 * blocks, b"\0")
    return head.ljust(512, b"\0") + middle + data + bytes(-len(data) % 512)


def _floats(values: np.ndarray, processor: int) -> bytes:
    if processor != DEC:
        return values.astype("<f4").tobytes()
    halves = (values * 4).astype("<f4").view("<u2").reshape(-1, 2)[:, ::-1]
    return np.ascontiguousarray(halves).tobytes()
