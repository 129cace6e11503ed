"""Decimal text to numbers, many at once and each exactly as Python's `float` would read it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from engine.take import Array, Mask

Bytes = npt.NDArray[np.uint8]
Places = npt.NDArray[np.int64]
Words = npt.NDArray[np.uint64]
WORD = 8  # bytes that are read at once
DIGITS = 15  # so many are a whole number below 2**53, which a float64 holds exactly
POINT, MINUS = ord("."), ord("-")
_ZEROS = np.uint64(0x3030303030303030)  # eight times the digit 0
_KEPT = np.array([(1 << 64) - (1 << 8 * (WORD - count)) for count in range(WORD + 1)], np.uint64)  # the last bytes
_POWERS = 10.0 ** np.arange(2 * WORD + 1)  # exact up to 10**22
_WHOLE_POWERS = 10 ** np.arange(2 * WORD + 1)


def floats(text: Bytes, starts: Places, ends: Places) -> Array:
    """Return the numbers that stand at text[start:end], (n,) each; `ValueError(index)` names the first that is none.

    The digits of `-12.345` are read as a whole number, eight at a time (Lemire, "Quickly parsing eight digits", 2018),
    and divided by a power of ten. Both are exact in float64, so that the one division rounds as `float` does (Clinger,
    "How to read floating point numbers accurately", 1990). What is written otherwise is left to `float`.
    """
    room = np.concatenate([np.full(2 * WORD, ord(","), np.uint8), text])
    points = np.flatnonzero(room == POINT)
    begins, stops = starts + 2 * WORD, ends + 2 * WORD
    begins = begins + (room[begins] == MINUS)
    point = points[np.searchsorted(points, begins).clip(max=len(points) - 1)] if len(points) else stops
    point = np.where(point < stops, point, stops)
    behind = np.maximum(stops - point - 1, 0)
    before = point - begins
    plain = (before > 0) & (before <= WORD) & (before + behind <= DIGITS)
    before, behind = np.where(plain, before, 1), np.where(plain, behind, 0)
    whole, digits = _whole(room, point, before)
    low, low_digits = _whole(room, stops, np.minimum(behind, WORD))
    high, high_digits = _whole(room, stops - WORD, np.maximum(behind - WORD, 0))
    mantissa = whole * _WHOLE_POWERS[behind] + high * _WHOLE_POWERS[WORD] + low
    numbers = mantissa / _POWERS[behind]
    np.negative(numbers, out=numbers, where=begins > starts + 2 * WORD)
    for index in np.flatnonzero(~(plain & digits & low_digits & high_digits)).tolist():
        try:
            numbers[index] = float(text[starts[index] : ends[index]].tobytes())
        except ValueError:
            raise ValueError(index) from None
    return np.asarray(numbers)


def _whole(room: Bytes, stops: Places, counts: Places) -> tuple[Places, Mask]:
    """Return the whole number in the `counts` bytes, at most eight, before `stops`, and whether all are digits."""
    words: Words = np.ndarray((len(room) - WORD + 1,), "<u8", room, strides=(1,))
    digits = (words[stops - WORD] ^ _ZEROS) & _KEPT[counts]
    good = ((digits + np.uint64(0x7676767676767676)) | digits) & np.uint64(0x8080808080808080) == 0
    pairs = digits * np.uint64(10) + (digits >> np.uint64(8))
    mask = np.uint64(0x000000FF000000FF)
    odd = (pairs & mask) * np.uint64(100 + (1_000_000 << 32))
    even = (pairs >> np.uint64(16) & mask) * np.uint64(1 + (10_000 << 32))
    return ((odd + even) >> np.uint64(32)).astype(np.int64), good
