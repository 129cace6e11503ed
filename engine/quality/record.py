"""The flag: an automatic finding on a range of frames."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from engine.words import counted

LEAST = 0.2  # weight of the lightest flag


@dataclass(frozen=True)
class Flag:
    """An automatic finding on the frames start to stop (half-open), of `KINDS`; weight is 0..1, the heaviest 1."""

    kind: str
    start: int
    stop: int
    weight: float
    sentence: str


def weight_of(amount: float, least: float, full: float) -> float:
    """Return the weight of a finding that is `LEAST` at the threshold, 1 at `full` and beyond."""
    share = (amount - least) / (full - least) if full > least else 1.0
    # Rounded, so that it is the same whether curves were measured whole or in parts.
    return round(float(min(1.0, LEAST + (1 - LEAST) * share)), 9)


def in_order(flags: Iterable[Flag]) -> tuple[Flag, ...]:
    """Return flags by their first frame."""
    return tuple(sorted(flags, key=lambda flag: (flag.start, flag.kind, flag.stop, flag.sentence)))


def lasting(frames: int, fps: float) -> str:
    """Return how long a range is, in frames and seconds."""
    return counted(frames, "frame") + (f" ({frames / fps:.2f} s)" if frames > 1 else "")
