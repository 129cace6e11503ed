"""Timecodes as editors count them: exact rates, and labels dropped at 29.97 and 59.94 frames per second."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

NTSC_RATES = (24, 30, 48, 60, 120)  # frames per second that television slows down by 1000 / 1001
DROPPING = (30, 60, 120)  # of them those whose labels are dropped
SLACK = 0.006  # frames per second: 23.98 is 24000 / 1001, which is 23.976; the next whole rate is .024 away
MINUTES_OF_A_CYCLE = 10  # only every tenth minute keeps all its labels
DAY_S = 86_400


@dataclass(frozen=True)
class Counting:
    """How the frames of a rate are labelled.

    Attributes
    ----------
    rate : frames per second, exact
    base : labels of a second, such as 30 at 29.97 frames per second
    drop : whether labels are left out, so that they keep up with the time of day
    """

    rate: Fraction
    base: int
    drop: bool

    def count_at(self, time_s: float) -> int:
        """Return the number of frames counted from midnight to a time of day in seconds, as a label reads it."""
        return round(time_s * (self.rate if self.drop else self.base))

    def label(self, count: int) -> str:
        """Return ``HH:MM:SS:FF`` of a number of frames since midnight, ``HH:MM:SS;FF`` where labels are dropped.

        With drop labels the first two of each minute at 30 a second, four at 60, are left out but in every tenth minute
        (SMPTE 12M). After a day labels begin anew.
        """
        number = count % self._day + self._dropped_before(count % self._day)
        seconds, frame = divmod(number, self.base)
        digits = max(2, len(str(self.base - 1)))
        mark = ";" if self.drop else ":"
        return f"{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}{mark}{frame:0{digits}d}"

    @property
    def _day(self) -> int:
        """Number of frames that are labelled in a day."""
        minutes = 24 * 60
        left_out = self._step * (minutes - minutes // MINUTES_OF_A_CYCLE)
        return DAY_S * self.base - left_out

    @property
    def _step(self) -> int:
        """Number of labels left out in a minute that leaves any out."""
        return self.base // 15 if self.drop else 0

    def _dropped_before(self, count: int) -> int:
        """Return how many labels were left out before the label of a frame."""
        if not self.drop:
            return 0
        minute = 60 * self.base - self._step
        cycle = MINUTES_OF_A_CYCLE * minute + self._step
        cycles, rest = divmod(count, cycle)
        minutes = max(0, rest - self._step) // minute
        return self._step * (cycles * (MINUTES_OF_A_CYCLE - 1) + minutes)


def rate_of(fps: float) -> Fraction:
    """Return a rate as editors mean it: 29.97 is 30000 / 1001."""
    base = round(fps)
    slowed = Fraction(base * 1000, 1001)
    if base in NTSC_RATES and abs(fps - slowed) < SLACK:
        return slowed
    return Fraction(fps).limit_denominator(1000)


def counting_of(fps: float) -> Counting:
    """Return how frames at a rate are labelled."""
    rate, base = rate_of(fps), max(1, round(fps))
    return Counting(rate, base, base in DROPPING and rate == Fraction(base * 1000, 1001))
