"""Timecodes as writers of takes write them, in every style and at every rate."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache

RATES = [24, 25, 29.97, 30, 48, 50, 59.94, 60, 120]
EXACT = {29.97: Fraction(30000, 1001), 59.94: Fraction(60000, 1001)}
Stamps = Callable[[int, Fraction], str]  # the frame counted from midnight, and the rate -> a timecode


def exact(rate: float) -> Fraction:
    return EXACT.get(rate, Fraction(rate))


def clocked(seconds: Fraction | int) -> str:
    whole = int(seconds) % 86400
    return f"{whole // 3600:02d}:{whole // 60 % 60:02d}:{whole % 60:02d}"


def sixtieths(frame: int | Fraction, rate: Fraction) -> str:
    ticks = Fraction(round(frame / rate * 60_000), 1000)
    return f"{clocked(ticks / 60)}:{float(ticks % 60):06.3f}"


def whole_sixtieths(frame: int, rate: Fraction) -> str:
    return f"{clocked(frame / rate)}:{int(frame / rate * 60) % 60:02d}"


def thousandths(frame: int, rate: Fraction) -> str:
    seconds = Fraction(round(frame / rate * 1000), 1000)
    return f"{clocked(seconds)}:{int(seconds % 1 * 1000):03d}"


def pointed(frame: int, rate: Fraction) -> str:
    return thousandths(frame, rate)[:8] + "." + thousandths(frame, rate)[9:]


def seconds(frame: int, rate: Fraction) -> str:
    return f"{float(frame / rate):.4f}"


def plain_thousandths(frame: int, rate: Fraction) -> str:
    return str(round(frame / rate * 1000))


def frames(frame: int, rate: Fraction) -> str:
    base = round(rate)
    return f"{clocked(frame // base)}:{frame % base:02d}"


def frames_and_zeros(frame: int, rate: Fraction) -> str:
    return frames(frame, rate) + ".000"


def numbered(frame: int, rate: Fraction) -> str:
    return f"{frames(frame, rate)}.{(frame + 1) % 1000:03d}"


def pointed_frames(frame: int, rate: Fraction) -> str:
    return ".".join(frames(frame, rate).rsplit(":", 1))


def part_frames(frame: int, rate: Fraction) -> str:
    base = round(rate)
    count = Fraction(round(frame / rate * base * 1000), 1000)
    return f"{clocked(count / base)}:{float(count % base):06.3f}"


def drop_frames(frame: int, rate: Fraction) -> str:
    """Plain counting, one label at a time: the first two (four at 59.94) of a minute are left out but each tenth."""
    base, each = round(rate), round(rate) // 15
    tens, rest = divmod(frame, 600 * base - 9 * each)
    frame += 9 * each * tens + (each * ((rest - each) // (60 * base - each)) if rest >= each else 0)
    return f"{clocked(frame // base)};{frame % base:02d}"


def drop_frames_unsaid(frame: int, rate: Fraction) -> str:
    return drop_frames(frame, rate).replace(";", ":")


REAL_TIME = [sixtieths, whole_sixtieths, thousandths, pointed, seconds, plain_thousandths, part_frames]
LABELS = [frames, frames_and_zeros, numbered, pointed_frames]  # which run slow at 29.97 and 59.94
CASES = [
    # whole sixtieths of 59.94 fps are those of 60 fps with a frame missing every seventeen seconds
    *[(style, rate) for style in REAL_TIME for rate in RATES if (style, rate) != (whole_sixtieths, 59.94)],
    *[
        (style, rate)
        for style in LABELS
        for rate in RATES
        if rate not in EXACT and (style, rate) != (pointed_frames, 120)
    ],
    *[(style, rate) for style in (drop_frames, drop_frames_unsaid) for rate in EXACT],
]


def stamps(style: Stamps, rate: float, rows: list[int], start_s: float = 35_995.5) -> list[bytes]:
    first, known = int(start_s * exact(rate)), said(style, rate)
    for frame in (first + row for row in rows):
        if frame not in known:
            known[frame] = style(frame, exact(rate)).encode()
    return [known[first + row] for row in rows]


@cache
def said(style: Stamps, rate: float) -> dict[int, bytes]:
    """Return the timecodes by frame that were made so far: they are asked for again and again."""
    return {}


def named(value: object) -> str:
    return getattr(value, "__name__", str(value))


def length(style: Stamps, rate: float) -> int:
    """Return how many rows show what a style does: dropped labels that nothing speaks of are seen at a minute's end."""
    return round((65 if style is drop_frames_unsaid else 9) * rate)
