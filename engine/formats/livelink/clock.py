"""Which frame each row of a Live Link Face CSV is, and how many there are in a second, judged by all its timecodes.

One odd stamp says nothing of the others: rows stand in the order in which they were recorded, the usual step between
them tells the rate, and a stamp counts only where those after it agree with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from engine.formats.livelink.origin import lost_frames
from engine.formats.livelink.timecode import LONGEST_STEP_S, SHORTEST_STEP_S, Style, middle, read_times
from engine.formats.livelink.walk import MAX_FRAMES, Walked, walk
from engine.take import Array, Mask, runs
from engine.words import counted, plural

STANDARD_FPS = (
    *(15.0, 20.0, 24000 / 1001, 24.0, 25.0, 30000 / 1001, 30.0, 48.0, 50.0),
    *(60000 / 1001, 60.0, 90.0, 100.0, 120000 / 1001, 120.0, 240.0),
)
NEAR = 0.0025  # a rate this close to a standard one is that one: clocks run up to 0.2 % fast or slow
FALLBACK_FPS = 30.0
SLOWEST_FPS, FASTEST_FPS = 1.0, 1000.0
MOST_ODD = 0.25  # share of stamps out of order beyond which none is believed
BLOCKS = (25, 13)  # rows over which a rate must explain coarse stamps; fewer where rows are missing in most of them
MANY_ALIKE = 0.1  # share of rows with the stamp of the row before, beyond which the clock is coarser than it is written
EXPLAINED = 0.6  # share of such blocks that it must explain
ADVICE = "Set the rate in the import line, or with --fps, if it is another."


@dataclass(frozen=True, eq=False)
class Clock:
    """Frame rate and frame number of each row.

    Attributes
    ----------
    fps : frames per second
    rows : (rows,) int, the frame that each row is, rising
    start_s : time of the first row, seconds after midnight
    reason : where the rate is from, in a few words
    style : what the timecodes count; None where they are no times
    missed : frames between rows that the clock counts and the file lacks
    odd : rows whose timecode was not believed
    notices : what the user should hear
    told_fps : the rate that the timecodes tell, where another is taken in its place
    """

    fps: float
    rows: npt.NDArray[np.int64]
    start_s: float = 0.0
    reason: str = "as asked"
    style: Style | None = None
    missed: int = 0
    odd: int = 0
    notices: tuple[str, ...] = field(default=())
    told_fps: float | None = None

    @property
    def file_fps(self) -> float:
        """Frames per second by the timecodes, whatever is taken in place of it."""
        return self.told_fps or self.fps


def clock_of(timecodes: Sequence[bytes], fps: float | None = None) -> Clock:
    """Return the clock of a file's timecodes; `fps` is taken in place of the rate that they tell."""
    found = _believed(timecodes) if len(timecodes) > 1 else _alone(timecodes)
    if fps is None:
        return found
    sentences = f"Taken as {fps:.6g} fps, as asked" + (
        f"; the timecodes say {found.fps:.6g}." if found.style is not None and len(timecodes) > 1 else "."
    )
    kept = [notice for notice in found.notices if not notice.startswith(("The timecodes make", "One frame", "Taken"))]
    return Clock(
        fps, found.rows, found.start_s, "as asked", found.style, found.missed, found.odd, (sentences, *kept), found.fps
    )


def _alone(timecodes: Sequence[bytes]) -> Clock:
    read = read_times(timecodes)
    start_s = float(read[1][0]) % read[0].day_s if read is not None else 0.0
    notice = f"One frame has no rate: taken as {FALLBACK_FPS:g} fps."
    return Clock(
        FALLBACK_FPS, np.arange(len(timecodes)), start_s, "one frame has none", read and read[0], notices=(notice,)
    )


def _believed(timecodes: Sequence[bytes]) -> Clock:
    """Return the clock that timecodes tell, or the rows one by one at a usual rate where they tell none."""
    read = read_times(timecodes)
    if read is None:
        return _row_by_row(len(timecodes), "The timecodes make no sense")
    style, times = read
    if style.base == 0:
        return _numbered(times, style)
    times, unread = _unbroken(times, style.day_s)
    quantum_s = _resolution(times, style)
    step_s = _usual_step(times, quantum_s)
    if not SHORTEST_STEP_S <= step_s <= LONGEST_STEP_S:
        return _row_by_row(len(times), "The timecodes make no sense")
    walked = walk(times, step_s, quantum_s)
    if len(walked.odd) > max(2, MOST_ODD * len(times)):
        return _row_by_row(len(times), "Most timecodes are out of order")
    rate, measured = _rate(times, walked, quantum_s=quantum_s, step_s=step_s)
    if walked.rows[-1] >= len(times):  # the longer a pause, the more exactly must the step be known
        length_s = len(times) / measured
        exact = rate if abs(rate / measured - 1) * length_s < 2 * quantum_s else measured
        walked = walk(times, 1 / exact, quantum_s)
    missed = int(walked.rows[-1]) + 1 - len(times)
    reason = f"from {style.described}"
    odd = len(set(walked.odd) | set(np.flatnonzero(unread).tolist()))
    notices = [*_said_rate(style, rate, measured, quantum_s), *_said_odd(odd, walked), *_said_missed(walked.rows, rate)]
    first = next(row for row in range(len(times)) if row not in walked.odd)
    start_s = float(times[first] - walked.rows[first] / rate) % style.day_s
    return Clock(rate, walked.rows, start_s, reason, style, missed, odd, tuple(notices))


def _row_by_row(rows: int, why: str) -> Clock:
    notice = f"{why}: taken as {FALLBACK_FPS:g} fps, row by row. {ADVICE}"
    return Clock(FALLBACK_FPS, np.arange(rows), reason="assumed", notices=(notice,))


def _numbered(numbers: Array, style: Style) -> Clock:
    """Return the clock of rows that are numbered as frames, which tells what is missing and no rate."""
    steps = np.diff(numbers)
    rising = bool(np.isfinite(steps).all() and (steps >= 1).all() and numbers[-1] - numbers[0] < MAX_FRAMES)
    rows = (numbers - numbers[0]).astype(np.int64) if rising else np.arange(len(numbers))
    missed = int(rows[-1]) + 1 - len(rows)
    notice = f"The rows are numbered, not timed: taken as {FALLBACK_FPS:g} fps. {ADVICE}"
    return Clock(FALLBACK_FPS, rows, 0.0, "assumed", style, missed, 0, (notice, *_said_missed(rows, FALLBACK_FPS)))


def _unbroken(times: Array, day_s: float) -> tuple[Array, Mask]:
    """Return times that go on past midnight, with what is no time filled in, and where that was."""
    unread: Mask = ~np.isfinite(times)
    if unread.any():
        places = np.arange(len(times))
        times = np.interp(places, places[~unread], times[~unread])
    return np.unwrap(times, period=day_s), unread


def _resolution(times: Array, style: Style) -> float:
    """Return the smallest difference in seconds of two stamps: as they are written, or coarser where many are the same."""
    written = max(style.quantum_s, float(np.spacing(np.abs(times).max())))
    steps = np.diff(times)
    again = np.abs(steps) < 0.5 * written
    forward = steps[steps > 0.5 * written]
    return max(written, float(np.quantile(forward, 0.1))) if again.mean() > MANY_ALIKE and len(forward) else written


def _usual_step(times: Array, quantum_s: float) -> float:
    """Return the seconds from one row to the next where none is missing.

    It is the mean of the steps near the median. Where stamps are no finer than frames, such a mean would take the
    uneven steps of a rate that does not divide the second for missing rows: there a standard rate is taken if it
    explains how the stamps lie, block by block.
    """
    steps = np.diff(times)
    forward = steps[steps > 0]
    if not len(forward):
        return 0.0
    usual = middle(forward)
    near = forward[np.abs(forward / usual - 1) < 0.5]
    mean = float(near.mean())
    if quantum_s < 0.2 * mean:
        return mean
    overall = (len(times) - 1) / max(float(times[-1] - times[0]), quantum_s)
    for rows in BLOCKS:
        shares = {rate: _explained(times, 1 / rate, quantum_s, rows) for rate in (1 / mean, *STANDARD_FPS)}
        best = max(shares.values())
        if best >= EXPLAINED:
            as_good = [rate for rate, share in shares.items() if share > 0.98 * best]
            return mean if 1 / mean in as_good else 1 / min(as_good, key=lambda rate: abs(np.log(rate / overall)))
    return mean


def _explained(times: Array, step_s: float, quantum_s: float, rows: int) -> float:
    """Return the share of blocks of rows whose stamps are those of an even step, cut off to the clock's resolution."""
    size = min(rows, len(times))
    blocks = times[: len(times) // size * size].reshape(-1, size)
    left = blocks - blocks[:, :1] - step_s * np.arange(size)
    spread = left.max(axis=1) - left.min(axis=1)
    return float((spread < quantum_s * (1 - 1e-6) + 0.02 * step_s).mean())


def _rate(times: Array, walked: Walked, *, quantum_s: float, step_s: float) -> tuple[float, float]:
    """Return frames per second, and what the plain steps of the clock measure; a standard rate where one is near."""
    believed = np.delete(np.arange(len(times)), walked.odd)
    frames, steps = np.diff(walked.rows[believed]), np.diff(times[believed])
    broken = np.searchsorted(believed, walked.set_back)
    plain = (
        (frames == np.diff(believed))
        & (steps < 2 * step_s * frames + 1.5 * quantum_s)
        & ~np.isin(np.arange(1, len(believed)), broken)
    )
    length = float(steps[plain].sum())
    measured = float(frames[plain].sum()) / length if plain.any() and length > 0 else 1 / step_s
    if walked.uneven and times[-1] > times[0]:  # its ends tell more than what lies between them
        measured = float(walked.rows[-1]) / float(times[-1] - times[0])
    if not 0.8 < measured * step_s < 1.25:
        measured = 1 / step_s
    near = max(NEAR, min(0.02, quantum_s / length if length > 0 else 0.02))
    nearest = min(STANDARD_FPS, key=lambda standard: abs(standard - measured))
    return (nearest if abs(nearest / measured - 1) < near else measured), measured


def _said_rate(style: Style, rate: float, measured: float, quantum_s: float) -> list[str]:
    """Say what the timecodes count where that is not what the app writes, and whether their clock is off."""
    sentences = []
    if style != Style(decimals=style.decimals, digits=style.digits):
        sentences.append(f"Taken as {rate:.6g} fps, from {style.described}.")
    if abs(measured / rate - 1) > 5e-4 and quantum_s < 0.2 / rate:
        sentences.append(f"The clock of the file says {measured:.5g} fps; taken as {rate:.6g}, the nearest usual rate.")
    return sentences


def _said_odd(odd: int, walked: Walked) -> list[str]:
    sentences = []
    if odd:
        sentences.append(f"{counted(odd, 'timecode')} out of order, placed by the rows beside.")
    if walked.uneven:
        return ["The clock runs unevenly; the rows are taken at even steps."]
    if walked.set_back:
        times = "once" if len(walked.set_back) == 1 else f"{len(walked.set_back)} times"
        sentences.append(f"The clock was set back {times}; the rows go on without a gap.")
    if walked.pauses:
        longest = max(walked.pauses)
        sentences.append(f"A leap of the clock by {longest:,.0f} s was left out; the rows after it follow at once.")
    return sentences


def _said_missed(rows: npt.NDArray[np.int64], fps: float) -> list[str]:
    """Say what became of frames without a row: a few are interpolated, long gaps are lost."""
    gone = lost_frames(rows, np.zeros(len(rows), bool), fps)
    missed, lost = int(rows[-1]) + 1 - len(rows) - int(gone.sum()), int(gone.sum())
    sentences = []
    if missed:
        sentences.append(
            f"{counted(missed, 'missed frame')} {plural(missed, 'was', 'were')} filled in from the frames beside."
        )
    if lost:
        gaps = len(runs(gone))
        length_s = f"{lost / fps:.2f} s" if lost < 10 * fps else f"{lost / fps:,.0f} s"
        where = f"a gap of {length_s}" if gaps == 1 else f"{gaps} gaps, {length_s} in all"
        sentences.append(f"The file has no rows over {where}; the frames there are marked as lost.")
    return sentences


def timecodes_between(
    timecodes: Sequence[bytes], rows: npt.NDArray[np.int64], frames: Sequence[int], *, fps: float
) -> list[bytes]:
    """Return timecodes in sequence, in the style of a file's own, for frames that it has no row for.

    `timecodes` and `rows`, (rows,), are those of the file: what each row says, and which frame it is.
    """
    read = read_times(timecodes)
    style, times = read if read is not None else (Style(), rows / fps)
    times, _ = _unbroken(times, style.day_s)
    texts = []
    for frame in frames:
        after = int(np.clip(np.searchsorted(rows, frame), 1, max(1, len(rows) - 1)))
        before = after - 1 if rows[after - 1] < frame or after == 1 else after
        time = float(times[before]) + (frame - int(rows[before])) / (fps if style.base else 1.0)
        if after < len(rows) and rows[before] < frame < rows[after]:
            share = (frame - rows[before]) / (rows[after] - rows[before])
            even = float(times[after] - times[before]) * share
            steps = even / max(1, frame - int(rows[before])) * (fps if style.base else 1.0)
            time = float(times[before]) + even if 0.5 < steps < 2 else time
        texts.append(style.write(time))
    return texts
