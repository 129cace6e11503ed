"""Puts two takes on one clock: by their timecodes, or by the lag at which their motion correlates best."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from engine.errors import EditError
from engine.models.resample import interpolate
from engine.take import MODEL_FPS, Array, Mask, Take

By = Literal["timecode", "correlation", "start", "offset"]


@dataclass(frozen=True)
class Tuning:
    """Constants of the alignment.

    Attributes
    ----------
    overlap_s : seconds two takes must share [0.25 .. 2]; below, chance peaks of the correlation win
    overlap_share : of the shorter take that must be shared, [0.1 .. 0.5]
    alike : correlation from which two takes count as one performance [0.5 .. 0.8]: at its best lag a take of 5 s
        reaches .56 with another person's, takes of a minute .42; parts and noisy copies of one take stay above .9
    """

    overlap_s: float = 1.0
    overlap_share: float = 0.25
    alike: float = 0.65


@dataclass(frozen=True)
class Alignment:
    """Where a second take lies on the clock of a first.

    Attributes
    ----------
    offset_s : seconds; time t of the second take is time t + offset_s of the first
    by : source of the offset
    correlation : of the motion of both where they overlap, -1..1; of one performance it is near 1
    """

    offset_s: float
    by: By
    correlation: float

    @property
    def alike(self) -> bool:
        """Whether the two look like one performance."""
        return self.correlation >= Tuning.alike

    @property
    def sentence(self) -> str:
        """What to tell the user."""
        how = {
            "timecode": "aligned by timecode",
            "correlation": "aligned by their motion",
            "start": "aligned at their first frames",
            "offset": "aligned as asked",
        }[self.by]
        return f"{how}, offset {self.offset_s:+.3f} s"


def align(before: Take, after: Take, *, offset_s: float | None = None) -> Alignment:
    """Return where `after` lies on the clock of `before`.

    An offset that is given wins, then timecodes under which both move alike. Else the lag with the highest normalised
    correlation of all 52 curves is taken, unless both have one length and rate, as edits do, and either move alike from
    the start or nowhere: of a take whose frames are mostly lost the motion tells nothing.

    Raises `EditError` where an offset leaves no common frame.
    """
    if offset_s is not None:
        _require_overlap(before, after, offset_s)
        return Alignment(offset_s, "offset", _correlation_at(before, after, offset_s))
    same_clock = before.fps == after.fps and len(before) == len(after)
    if before.start_s > 0 and after.start_s > 0:
        by_timecode_s = after.start_s - before.start_s
        if _overlap_s(before, after, by_timecode_s) >= _needed_s(before, after):
            correlation = _correlation_at(before, after, by_timecode_s)
            if correlation >= Tuning.alike or (same_clock and abs(by_timecode_s) * after.fps < 0.5):
                return Alignment(by_timecode_s, "timecode", correlation)
    together = _correlation_at(before, after, 0.0)
    if same_clock and together >= Tuning.alike:
        return Alignment(0.0, "start", together)
    lag = _best_lag(before, after)
    correlation = _correlation_at(before, after, lag)
    if same_clock and correlation < Tuning.alike:
        return Alignment(0.0, "start", together)
    if together >= max(Tuning.alike, correlation):
        return Alignment(0.0, "start", together)
    return Alignment(lag, "correlation", correlation)


def on_clock_of(after: Take, before: Take, offset_s: float) -> tuple[Array, Mask]:
    """Return the weights of `before` at the frames of `after`, (frames, 52), and where it has any, (frames,) bool.

    At whole frames of equal rates they are the recorded values, bit for bit; between frames they are interpolated.
    """
    at = (np.arange(len(after)) / after.fps + offset_s) * before.fps
    whole = np.round(at)
    at = np.where(np.abs(at - whole) < 1e-3, whole, at)
    return interpolate(before.weights, at), (at >= 0) & (at <= len(before) - 1)


def beside(before: Take, after: Take, *, offset_s: float | None = None) -> Take:
    """Return `before` as it is shown beside `after`, frame by frame.

    It is put on the clock of `after`, where the two are one performance or an offset is given; before its first frame
    and after its last it stands still. Two performances begin together.
    """
    found = align(before, after, offset_s=offset_s)
    shift_s = found.offset_s if found.alike or offset_s is not None else 0.0
    if before.fps == after.fps and shift_s == 0.0:
        return before
    weights, common = on_clock_of(after, before, shift_s)
    return Take(weights, after.fps, lost=~common, name=before.name, start_s=after.start_s)


def _overlap_s(before: Take, after: Take, offset_s: float) -> float:
    return min(before.duration_s, after.duration_s + offset_s) - max(0.0, offset_s)


def _needed_s(before: Take, after: Take) -> float:
    shorter = min(before.duration_s, after.duration_s)
    return min(shorter, max(Tuning.overlap_s, Tuning.overlap_share * shorter))


def _require_overlap(before: Take, after: Take, offset_s: float) -> None:
    if not np.isfinite(offset_s) or _overlap_s(before, after, offset_s) <= 0:
        raise EditError(
            f"At an offset of {offset_s:g} s, {before.name} and {after.name} have no frame in common.",
            f"They last {before.duration_s:.1f} s and {after.duration_s:.1f} s.",
        )


def _curves(take: Take) -> Array:
    """Return the weights at the model rate, (model frames, 52)."""
    frames = max(1, round(take.duration_s * MODEL_FPS))
    return interpolate(take.weights, np.arange(frames, dtype=np.float64) * (take.fps / MODEL_FPS))


def _correlation_at(before: Take, after: Take, offset_s: float) -> float:
    """Return the correlation of two takes' curves over their common frames; 1 where both rest."""
    theirs, common = on_clock_of(after, before, offset_s)
    if not common.any():
        return 0.0
    a, b = theirs[common], after.weights[common]
    a, b = a - a.mean(axis=0), b - b.mean(axis=0)
    power = float(np.sqrt((a**2).sum() * (b**2).sum()))
    return float((a * b).sum() / power) if power > 1e-9 else float(np.allclose(a, b))


def _best_lag(before: Take, after: Take) -> float:
    """Return the offset in seconds with the highest correlation over a long enough overlap.

    ``r(l) = sum_t a(t + l) b(t) / sqrt(sum_t a(t + l)^2 sum_t b(t)^2)`` over the frames both have at lag l, with each
    curve's mean over its whole take removed; 0 where nothing moves alike.
    """
    from scipy.signal import correlate  # a third of a second to load, and the window should be seen first

    a, b = _curves(before), _curves(after)
    a, b = a - a.mean(axis=0), b - b.mean(axis=0)
    lags = np.arange(-(len(b) - 1), len(a))
    moving = np.flatnonzero((a.std(axis=0) > 1e-4) & (b.std(axis=0) > 1e-4))
    product = np.zeros(len(lags))
    for column in moving:
        product += correlate(a[:, column], b[:, column], mode="full", method="fft")
    energy_a, energy_b = (np.concatenate([[0.0], np.cumsum((each**2).sum(axis=1))]) for each in (a, b))
    first, last = np.maximum(lags, 0), np.minimum(len(a), lags + len(b))  # the frames of `before` that both have
    power = np.sqrt((energy_a[last] - energy_a[first]) * (energy_b[last - lags] - energy_b[first - lags]))
    long_enough = (last - first) >= _needed_s(before, after) * MODEL_FPS - 1
    score = np.where(long_enough & (power > 1e-9), product / np.maximum(power, 1e-9), -1.0)
    return float(lags[np.argmax(score)] / MODEL_FPS) if score.max() > 0 else 0.0
