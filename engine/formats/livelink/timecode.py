"""The texts in the first column of a Live Link Face CSV: what they count, read as seconds and written back.

The app writes `HH:MM:SS:FF.fff` with sixtieths of a second in the last field, whatever its rate. Other writers count
frames there, or milliseconds, drop labels as NTSC does, or give plain seconds.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from engine.formats.base.decimals import floats
from engine.take import Array, Mask

APP_BASE = 60  # the app counts sixtieths of a second, even in a 30 Hz take
DAY_S = 86400.0
NTSC = 1000 / 1001
DROP_BASES = (30, 60, 120)
# Counts of the last field per second: frame rates, then hundredths, thousandths and millionths.
BASES = (60, 24, 25, 30, 48, 50, 90, 100, 120, 240, 1000, 1_000_000)
FEWEST, MOST = 10, 240  # counts per second of a writer that keeps to no standard, such as a webcam's 15 or 28
BLOCK_ROWS = 4096  # of timecodes read at once
COLON = ord(":")
LARGEST = 1e13  # that a field may be: microseconds of some months
MOST_FIELDS = 4
LARGEST_FIELD, LARGEST_NUMBER = 1e7, 1e19  # of several numbers, microseconds at most; of one alone, those since 1970
SAMPLE = 200  # timecodes whose looks are taken for those of all
AGREE = 0.95  # share of the rows that must follow a rule for it to count
UNITS = (1, 1000, 1_000_000, 1_000_000_000)  # of plain numbers: seconds down to nanoseconds
LONGEST_STEP_S, SHORTEST_STEP_S = 0.5, 1 / 1000


@dataclass(frozen=True)
class Style:
    """How a file writes its times.

    Attributes
    ----------
    fields : numbers in a timecode: 4 are hours, minutes, seconds and counts, 1 is a number alone
    base : counts of the last field in a second; 1 where it is seconds, 0 where it is a frame's number
    digits, decimals : of the last field, before and behind the point
    drop : whether labels are left out at most minutes, as 29.97 and 59.94 fps do
    mark : text before the last field
    numbered : whether the decimals repeat the frame's number, or the thousandths of the second, and add no time
    ahead : what is added to the frame's number there; None where they are thousandths
    """

    fields: int = MOST_FIELDS
    base: int = APP_BASE
    digits: int = 2
    decimals: int = 3
    drop: bool = False
    mark: str = ":"
    numbered: bool = False
    ahead: int | None = 0

    @property
    def quantum_s(self) -> float:
        """The smallest difference in seconds that two timecodes can have."""
        decimals = 0 if self.numbered else min(self.decimals, 6)
        return 10.0**-decimals / self._counts_per_s

    @property
    def day_s(self) -> float:
        """Seconds after which the labels begin anew."""
        if self.drop:
            return (DAY_S * self.base - self._dropped(24 * 60)) / self._counts_per_s
        return DAY_S

    @property
    def described(self) -> str:
        """What it counts, in words."""
        if self.drop:
            return f"drop-frame timecodes of {self.base * NTSC:.4g} fps"
        if self.fields < MOST_FIELDS:
            names = {0: "frame numbers", 1: "seconds", 1000: "milliseconds", 1_000_000: "microseconds"}
            return f"times in {names.get(self.base, 'nanoseconds')}" if self.base else names[0]
        names = {APP_BASE: "sixtieths of a second", 100: "hundredths", 1000: "milliseconds", 1_000_000: "microseconds"}
        return f"timecodes that count {names.get(self.base, f'{self.base} frames a second')}"

    @property
    def _counts_per_s(self) -> float:
        return (self.base or 1) * (NTSC if self.drop else 1.0)

    def _dropped(self, minutes: float) -> float:
        """Return how many labels are left out in so many minutes."""
        return self.base // 15 * (minutes - minutes // 10)

    def seconds(self, fields: Array) -> Array:
        """Return times, (rows,) in seconds, of the numbers in timecodes, (rows, fields)."""
        whole = np.zeros(len(fields))
        for column in range(fields.shape[1] - (self.fields == MOST_FIELDS)):
            whole = 60 * whole + fields[:, column]
        if self.fields < MOST_FIELDS:
            return whole / (self.base or 1) if self.fields == 1 else whole
        counts = np.floor(fields[:, -1]) if self.numbered else fields[:, -1]
        if self.drop:
            minutes = whole // 60
            counts = counts - self.base // 15 * (minutes - minutes // 10)
        return np.asarray((whole * self.base + counts) / self._counts_per_s)

    def write(self, seconds: float) -> bytes:
        """Return the timecode of a time in seconds, after midnight where there are hours."""
        if self.fields == 1:
            return f"{seconds * (self.base or 1):.{self.decimals}f}".encode()
        decimals = 0 if self.numbered else self.decimals
        if self.fields < MOST_FIELDS:
            minutes, part = divmod(round(seconds % DAY_S, decimals), 60)
            return ":".join([*_sexagesimal(int(minutes), self.fields - 1), _padded(part, 2, decimals)]).encode()
        counts = round((seconds % self.day_s) * self._counts_per_s, decimals)
        number = int(counts)
        if self.drop:
            counts += self._dropped_before(int(counts))
        whole, part = divmod(counts, self.base)
        number = int(10**self.decimals * part / self.base) if self.ahead is None else number + self.ahead
        added = f".{number % 10**self.decimals:0{self.decimals}d}" if self.numbered else ""
        last = _padded(part, self.digits, decimals) + added
        return (":".join(_sexagesimal(int(whole) % int(DAY_S), 3)) + self.mark + last).encode()

    def _dropped_before(self, frame: int) -> int:
        """Return how many labels were left out before a frame of drop-frame counting."""
        each = self.base // 15
        ten = 600 * self.base - 9 * each
        tens, rest = divmod(frame, ten)
        first = 60 * self.base
        minutes = 0 if rest < first else 1 + (rest - first) // (first - each)
        return each * (9 * tens + minutes)


def _sexagesimal(whole: int, fields: int) -> list[str]:
    """Return a whole number as so many texts, all but the first below sixty."""
    texts: list[str] = []
    for _ in range(fields - 1):
        whole, rest = divmod(whole, 60)
        texts.insert(0, f"{rest:02d}")
    return [f"{whole:02d}", *texts] if fields else []


def _padded(number: float, digits: int, decimals: int) -> str:
    return f"{number:0{digits + bool(decimals) + decimals}.{decimals}f}"


def read_times(timecodes: Sequence[bytes]) -> tuple[Style, Array] | None:
    """Return the style of timecodes and their times, (rows,) in seconds, NaN for a text that is none.

    None where most of them are no times at all.
    """
    split = _split(timecodes)
    if split is None:
        return None
    fields, marks = split
    sample = [code for code in timecodes[:SAMPLE] if code.count(b":") + code.count(b";") == fields.shape[1] - 1]
    style = _looks(sample, fields.shape[1])
    if style.fields == 1:
        style = replace(style, base=_unit(fields[:, 0]))
    if style.fields == 3 and style.decimals == 2 and _counts_frames(fields):
        fields = _parted(fields)
        style = replace(style, fields=4, mark=".", digits=2, decimals=0)
    if style.fields == MOST_FIELDS:
        style = _counted(style, fields, semicolons=marks)
    return style, style.seconds(fields)


def _split(timecodes: Sequence[bytes]) -> tuple[Array, bool] | None:
    """Return the numbers of each timecode, (rows, fields), NaN for a text that has not as many, and whether by `;`."""
    counts = Counter(code.replace(b";", b":").count(b":") for code in timecodes)
    colons, many = counts.most_common(1)[0]
    if colons >= MOST_FIELDS or 2 * many <= len(timecodes):
        return None
    semicolons = b";" in timecodes[0] + timecodes[-1] and 2 * sum(b";" in code for code in timecodes) > len(timecodes)
    blocks = [timecodes[first : first + BLOCK_ROWS] for first in range(0, len(timecodes), BLOCK_ROWS)]
    fields = np.concatenate([_numbers(block, colons + 1) for block in blocks])
    largest = LARGEST_FIELD if colons else LARGEST_NUMBER
    good = ((fields >= 0) & (fields <= largest)).all(axis=1)
    fields[~good] = np.nan
    return (fields, semicolons) if 2 * int(good.sum()) > len(timecodes) else None


def _numbers(timecodes: Sequence[bytes], fields: int) -> Array:
    """Return the numbers of some timecodes, (rows, fields), NaN for a text that has not as many."""
    text = np.frombuffer(b":".join(timecodes).replace(b";", b":") + b":", np.uint8)
    ends = np.flatnonzero(text == COLON)
    if len(ends) == fields * len(timecodes):
        try:
            numbers = floats(text, np.concatenate([[0], ends[:-1] + 1]), ends).reshape(-1, fields)
            return np.where(np.abs(numbers) <= LARGEST, numbers, np.nan)
        except ValueError:
            pass  # one of them is none: each is looked at alone
    if len(timecodes) > 1:
        half = len(timecodes) // 2
        return np.concatenate([_numbers(timecodes[:half], fields), _numbers(timecodes[half:], fields)])
    return np.full((1, fields), np.nan)


def _looks(sample: Sequence[bytes], fields: int) -> Style:
    """Return how timecodes look, before it is known what they count."""
    last = [code.replace(b";", b":").rpartition(b":")[2].strip() for code in sample]
    decimals = Counter(len(text.partition(b".")[2]) for text in last).most_common(1)[0][0]
    digits = min((len(text.partition(b".")[0].lstrip(b"-")) for text in last), default=2)
    return Style(fields, 1 if fields < MOST_FIELDS else APP_BASE, digits, min(decimals, 9))


def _unit(numbers: Array) -> int:
    """Return how many of a plain number make a second; 0 where they number the frames."""
    steps = np.diff(numbers[np.isfinite(numbers)])
    steps = steps[steps > 0]
    typical = float(np.median(steps)) if len(steps) else 0.0
    whole = bool((numbers[np.isfinite(numbers)] % 1 == 0).all())
    if whole and typical == 1.0:
        return 0
    return next((unit for unit in UNITS if SHORTEST_STEP_S < typical / unit <= LONGEST_STEP_S), 1)


def _parted(fields: Array) -> Array:
    """Return hours, minutes, seconds and counts of `HH:MM:SS.FF`."""
    whole = np.floor(fields[:, 2])
    return np.column_stack([fields[:, :2], whole, np.round(100 * (fields[:, 2] - whole))])


def _counts_frames(fields: Array) -> bool:
    """Whether the two digits behind a point are frames: at the seconds they begin anew before a hundred."""
    parted = _parted(fields[np.isfinite(fields).all(axis=1)])
    base = _base(parted)
    return base is not None and base < 100 and parted[:, 3].max() < base


def _counted(style: Style, fields: Array, *, semicolons: bool) -> Style:
    """Return the style with what its last field counts."""
    good = fields[np.isfinite(fields).all(axis=1)]
    base = _base(good) or _least_base(float(np.quantile(np.floor(good[:, 3]), AGREE)), style.digits)
    if style.decimals:
        style = _numbered(replace(style, base=base), good)
    drop = base in DROP_BASES and _drops(good, base, certain=semicolons)
    return replace(style, base=base, drop=drop, mark=";" if semicolons else style.mark)


def _whole_seconds(fields: Array) -> Array:
    return np.asarray(fields[:, 0] * 3600 + fields[:, 1] * 60 + fields[:, 2])


def _base(fields: Array) -> int | None:
    """Return the counts per second by which the last field goes on evenly where a second begins, None without one.

    Over a second's boundary, `last count + usual step - first count` is what a second holds. Most boundaries must agree:
    a row may be missing at any of them.
    """
    steps, counts = np.diff(_whole_seconds(fields)), fields[:, 3]
    inner = np.diff(counts)[steps == 0]
    inner = inner[inner > 0]
    before = np.flatnonzero((steps == 1) | (steps == 1 - DAY_S))
    if not len(before) or not len(inner):
        return None
    usual = middle(inner)
    usual = float(inner[np.abs(inner / usual - 1) < 0.6].mean())
    lengths = counts[before] + usual - counts[before + 1]
    votes = {base: int((np.abs(lengths - base) < max(0.5 * min(usual, 0.05 * base), 0.45)).sum()) for base in BASES}
    best: int = max(BASES, key=lambda base: votes[base])  # the app's own where there is a draw
    if 2 * votes[best] > len(lengths):
        return best
    counted: Counter[int] = Counter(int(each) for each in np.round(lengths))
    odd, many = counted.most_common(1)[0]
    sure = many >= 3 and many > max(0.6 * len(lengths), votes[best]) and FEWEST <= odd <= MOST and counts.max() <= odd
    if sure and abs(odd - APP_BASE) > 2 * usual:
        uneven = float((inner > 1.5 * np.median(inner)).mean()) > 0.1  # cut off to counts that a rate does not divide
        return odd + 1 if uneven and odd + 1 in BASES else odd
    return best if votes[best] else None


def middle(numbers: Array) -> float:
    """Return the median, (n,), of two in the middle the smaller one, so that it is one of them."""
    return float(np.sort(numbers)[(len(numbers) - 1) // 2])


def _least_base(largest: float, digits: int) -> int:
    """Return the counts per second of timecodes within one second, by the largest count there."""
    if digits > 2 and largest >= MOST:
        return 1000 if digits == 3 else 1_000_000
    return next(base for base in (APP_BASE, 100, MOST, 1000, 1_000_000, 10**12) if largest < base)


def _numbered(style: Style, fields: Array) -> Style:
    """Return the style with whether its decimals repeat the frame's number, the row's, or the second's thousandths."""
    wrap, counts = 10**style.decimals, np.floor(fields[:, 3])
    part = np.round((fields[:, 3] - counts) * wrap)
    if len(fields) < 5 or len(np.unique(part[:SAMPLE])) < 3:
        return style
    frame = _whole_seconds(fields) * style.base + counts
    # A genuine 59.94 fps from a whole frame on looks the same until the decimals wrap.
    unclear = style.base == APP_BASE and part[0] == 0 and len(fields) < wrap
    if not unclear and (_follows(part, frame, wrap) or _follows(part, np.arange(float(len(fields))), wrap)):
        ahead = Counter(int(each) for each in (part - frame) % wrap).most_common(1)[0][0]
        return replace(style, numbered=True, ahead=ahead)
    thousandths = np.abs(part / wrap - counts / style.base) < 1.5 / 1000
    return replace(style, numbered=True, ahead=None) if thousandths.mean() >= AGREE else style


def _follows(part: Array, number: Array, wrap: int) -> bool:
    """Whether decimals are a running number, counted from 0 or 1."""
    ahead = (part - number) % wrap
    return any(bool((ahead == start % wrap).mean() >= AGREE) for start in (-1, 0, 1))


def _drops(fields: Array, base: int, *, certain: bool) -> bool:
    """Whether labels are left out at the minutes but each tenth, or could be: `certain` where the text says so."""
    minutes = fields[:, 0] * 60 + fields[:, 1]
    begins: Mask = (fields[:, 2] == 0) & (minutes % 10 != 0)
    if certain:
        return not (begins & (fields[:, 3] < base // 15)).any()
    after = np.flatnonzero(np.diff(minutes) == 1) + 1
    after = after[begins[after]]
    whole = fields[after, 3] == base // 15
    last = fields[after - 1, 3] == base - 1
    return len(after) > 0 and bool((whole & last).all())
