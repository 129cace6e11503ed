"""From arrivals to a take at a constant rate: what came is kept as it came, what did not is marked lost."""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from engine.errors import EditError
from engine.live.packet import MAX_FPS, ROTATION_COUNT
from engine.take import SHAPES, Array, Take

if TYPE_CHECKING:  # the stream brings torch, and what is read back from a recording needs none
    from engine.live.stream import Arrival

MAX_FRAMES = 1_000_000  # over four and a half hours at 60 fps; a sender gone mad must not fill memory
# A sender whose clock leaps between packets declares frames by the million: 20,000 are five minutes at 60 fps.
FEW_FRAMES, FRAMES_PER_ARRIVAL = 20_000, 8
LEAPT = "The sender's clock leapt far ahead, again and again: the gaps were shortened."
STANDARD_FPS = (24.0, 25.0, 30.0, 50.0, 60.0, 120.0)
_CHUNK = 4096
_COLUMNS = 2 + len(SHAPES) + ROTATION_COUNT
_NONE: Array = np.zeros((0, _COLUMNS))


class Recorder:
    """Stores arrivals until they are fetched as a take; may be added to on one thread and read on another."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._clear()

    def _clear(self) -> None:
        self._chunks: list[np.ndarray] = []
        self._count = 0
        self._fps: list[float] = []

    def __len__(self) -> int:
        return self._count

    @property
    def full(self) -> bool:
        """Whether no more is kept."""
        return self._count >= MAX_FRAMES

    def add(self, arrival: Arrival) -> None:
        """Keep one arrival; beyond `MAX_FRAMES` nothing more is kept."""
        with self._lock:
            if self.full:
                return
            if self._count % _CHUNK == 0:
                self._chunks.append(np.full((_CHUNK, _COLUMNS), np.nan))
            row = self._chunks[-1][self._count % _CHUNK]
            row[0], row[1] = arrival.time_s, arrival.fps
            row[2 + len(SHAPES) :] = arrival.rotations
            if arrival.weights is not None:
                row[2 : 2 + len(SHAPES)] = arrival.weights
            self._count += 1

    def since(self, count: int) -> Array:
        """Return what was kept after the first `count` arrivals, (n, 63): time, rate, weights (NaN: no face), rotations."""
        with self._lock:
            kept = np.concatenate(self._chunks[count // _CHUNK :])[count % _CHUNK :] if count < self._count else _NONE
            return kept[: self._count - count]

    def take(self, name: str = "live") -> Take:
        """Return what was kept as a take at the sender's rate; raises `EditError` where no frame had a face.

        Frames that did not arrive, or had no face, are marked lost and interpolated; of a doubled frame the later
        arrival counts.
        """
        rows = self.since(0)
        if not len(rows) or not np.isfinite(rows[:, 2]).any():
            raise EditError("Nothing was recorded: no frame with a face arrived.", "Check port, address and subject.")
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        fps = rate_of(rows[:, 0], rows[:, 1])
        frame = np.round((rows[:, 0] - rows[0, 0]) * fps).astype(np.int64)
        kept = np.isfinite(rows[:, 2])
        frame, shortened = _within(frame, max(FEW_FRAMES, FRAMES_PER_ARRIVAL * len(frame)))
        first = frame[kept][0]  # interpolation before the first face would invent a still one
        taken = _on_grid(rows[kept], frame[kept] - first, int(frame[-1] - first) + 1, fps, name)
        return replace(taken, notices=(LEAPT,)) if shortened else taken


def _within(frame: npt.NDArray[np.int64], most: int) -> tuple[npt.NDArray[np.int64], bool]:
    """Return frame numbers, (n,) in order, whose gaps are shortened until there are at most so many frames in all."""
    steps = np.diff(frame)
    if not len(steps) or int(steps.sum()) < most:
        return frame, False
    longest = int(steps.max())
    while longest > 1 and int(np.minimum(steps, longest).sum()) >= most:
        longest //= 2
    return np.concatenate([[0], np.cumsum(np.minimum(steps, longest))]), True


def _on_grid(rows: Array, frame: np.ndarray, frames: int, fps: float, name: str) -> Take:
    grid = np.arange(frames)
    seen, last = np.unique(frame[::-1], return_index=True)
    values = rows[len(rows) - 1 - last, 2:]
    lost = np.ones(frames, bool)
    lost[seen] = False
    curves = np.stack([np.interp(grid, seen, column) for column in values.T], axis=1)
    curves[seen] = values
    return Take(curves[:, : len(SHAPES)], fps, lost, curves[:, len(SHAPES) :], name)


def rate_of(times_s: Array, stated_fps: Array) -> float:
    """Return the rate of sorted arrivals: of the typical step, snapped to a standard rate; senders' clocks may run at
    sixty ticks and send every other one."""
    steps = np.diff(times_s)
    steps = steps[steps > 0.5 / MAX_FPS]
    rate = 1 / float(np.median(steps)) if len(steps) else float(stated_fps[0])
    nearest = min(STANDARD_FPS, key=lambda standard: abs(standard - rate))
    return nearest if abs(nearest / rate - 1) < 0.02 else rate
