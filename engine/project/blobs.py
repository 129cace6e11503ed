"""Arrays as bytes: little-endian, compressed; their size is checked before any memory is taken."""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

SAMPLE_BYTES, SAMPLES = 4096, 16
WORTH_IT = (
    0.5  # recorded curves shrink by a quarter, at a twentieth of the disk's speed; an edit should be safe at once
)
MAX_RATIO = 1032  # no deflate stream can hold more bytes for each of its own
SLACK_BYTES = 64
PIECE_BYTES = 2**20
# What any project may unpack to; a larger one by the size of its file. Replaying holds the curves three times.
ORDINARY_BYTES = 192 * 2**20
ORDINARY_RATIO = 64
LARGE_BYTES = 16 * 2**20  # from here on nothing is packed by more than that ratio, so that all that is written is read


Pieces = list[bytes]


class DamagedError(ValueError):
    """What is stored cannot be what was written; the text says what is wrong with it."""


class Budget:
    """How many bytes a file may still unpack to, so that a small file cannot fill the memory."""

    def __init__(self, file_bytes: int) -> None:
        self.left = max(ORDINARY_BYTES, ORDINARY_RATIO * file_bytes)

    def take(self, count: int) -> None:
        """Spend bytes; raises `DamagedError` when there are not as many left."""
        if count > self.left:
            raise DamagedError("it unpacks to more than it can hold")
        self.left -= count


def pack(array: npt.NDArray[Any]) -> Pieces:
    """Return an array's values as little-endian bytes in a zlib stream, compressed where that saves half or more.

    The stream comes in pieces: Python lets no other thread run while it copies one, and an hour of curves is 90 MB.
    """
    content = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<")).reshape(-1).view("u1").data
    step = max(SAMPLE_BYTES, len(content) // SAMPLES)
    sample = b"".join(content[at : at + SAMPLE_BYTES] for at in range(0, len(content), step))
    packed = len(zlib.compress(sample, 1))
    refused = len(content) > LARGE_BYTES and packed * ORDINARY_RATIO < 2 * len(sample)
    worth_it = packed < WORTH_IT * len(sample) and not refused
    stream = zlib.compressobj(1 if worth_it else 0)
    pieces = [stream.compress(content[at : at + PIECE_BYTES]) for at in range(0, len(content), PIECE_BYTES)]
    return [*pieces, stream.flush()]


def unpack(blob: object, shape: tuple[int, ...], dtype: str, budget: Budget) -> npt.NDArray[Any]:
    """Return the array of a known shape and type (`<f8`, `<i8`, `u1`); raises `DamagedError` when it is not that."""
    count = int(np.prod(shape, dtype=object)) * np.dtype(dtype).itemsize
    return np.frombuffer(unpack_bytes(blob, count, budget), dtype=dtype).reshape(shape)


def unpack_bytes(blob: object, count: int, budget: Budget) -> bytes:
    """Return exactly `count` bytes; raises `DamagedError` when there are more, fewer or damaged ones."""
    if not isinstance(blob, bytes) or count > MAX_RATIO * len(blob) + SLACK_BYTES:
        raise DamagedError("values are missing")
    budget.take(count)
    stream = zlib.decompressobj()
    try:
        content = stream.decompress(blob, max(1, count)) if count else b""
        rest = stream.decompress(stream.unconsumed_tail if count else blob, 1)
    except zlib.error as error:
        raise DamagedError("values cannot be unpacked") from error
    if len(content) != count or rest or not stream.eof or stream.unused_data:
        raise DamagedError("it has another number of values than it says")
    return content
