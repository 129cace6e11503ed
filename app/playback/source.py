"""What a loudspeaker plays: samples from a place that moves through a recording, without a gap or a click."""

from __future__ import annotations

import threading
from collections import deque

import numpy as np
import numpy.typing as npt

from engine.formats.audio import Audio, Samples
from engine.take import Array

Loop = tuple[float, float]  # first and last second

RAMP_S = 0.004  # fading in and out, too short to be heard as such and long enough not to click
GRAIN_S = 0.08  # what is heard of a moment while scrubbing
BLOCKS_REMEMBERED = 64  # more than any device keeps waiting


def looped(at: float, loop: Loop | None) -> float:
    """Return a place brought into a loop; beyond its ends it goes round."""
    if loop is None or loop[1] <= loop[0]:
        return at
    return loop[0] + (at - loop[0]) % (loop[1] - loop[0])


class Source:
    """Hands out blocks; `pull` may run on another thread than all else.

    Parameters
    ----------
    audio : the recording
    offset_s : time in the take at which it begins
    out_rate : Hz of the device; samples in between are interpolated linearly
    """

    def __init__(self, audio: Audio, *, offset_s: float, out_rate: int) -> None:
        self._samples = audio.samples[:, None] if audio.samples.ndim == 1 else audio.samples
        self._rate, self._offset_s, self._out_rate = audio.rate, offset_s, out_rate
        self.muted = False
        self._lock = threading.Lock()
        self._at = self._step = 0.0  # samples of the recording; per sample of the device
        self._loop: Loop | None = None  # samples
        self._running = False
        self._gain = 0.0
        self._grains: list[tuple[float, int]] = []  # place in the recording, samples already played; negative: to wait
        self._next_grain: float | None = None
        self._blocks: deque[tuple[float, float, float]] = deque(maxlen=BLOCKS_REMEMBERED)  # heard from, until; place

    def shift(self, offset_s: float) -> None:
        """Let the recording begin at another time in the take; what is heard goes on until the next `play`."""
        with self._lock:
            self._offset_s = offset_s
            self._blocks.clear()

    @property
    def idle(self) -> bool:
        """Whether there is nothing to play."""
        return not (self._running or self._gain or self._grains or self._next_grain is not None)

    def play(self, at_s: float, speed: float, loop: Loop | None) -> None:
        """Move from a time in the take at a speed; nothing that was heard before counts for `heard`."""
        with self._lock:
            self._at, self._step = float(round(self._place(at_s))), speed * self._rate / self._out_rate
            self._loop = None if loop is None else (round(self._place(loop[0])), round(self._place(loop[1])))
            self._running = speed != 0.0
            self._blocks.clear()

    def stop(self) -> None:
        """Fade out."""
        with self._lock:
            self._running = False
            self._blocks.clear()

    def scrub(self, at_s: float) -> None:
        """Play a grain, after the one that runs is half over: halves of two grains add up to an even loudness."""
        with self._lock:
            self._next_grain = self._place(at_s) - GRAIN_S / 2 * self._rate

    def heard(self, now: float) -> tuple[float | None, float]:
        """Return the time in the take that is heard now, None before the first block; and until when there is sound."""
        with self._lock:
            until = self._blocks[-1][1] if self._blocks else -np.inf
            for heard_from, heard_until, place in reversed(self._blocks):
                if heard_from <= now:
                    moved = (min(now, heard_until) - heard_from) * self._out_rate * self._step
                    return looped(place + moved, self._loop) / self._rate + self._offset_s, until
        return None, until

    def pull(self, frames: int, heard_from: float) -> Samples:
        """Return the next block, (frames, channels), and remember when it is heard."""
        with self._lock:
            block = np.zeros((frames, self._samples.shape[1]), np.float32)
            if self._running:
                self._blocks.append((heard_from, heard_from + frames / self._out_rate, self._at))
            if self._running or self._gain:
                block += self._fade(frames)[:, None] * self._moving(frames)
            self._start_grain(frames)
            if self._grains:
                block += self._grainy(frames)
            return block

    def _place(self, time_s: float) -> float:
        return (time_s - self._offset_s) * self._rate

    def _moving(self, frames: int) -> Samples:
        places: Array = self._at + self._step * np.arange(frames + 1, dtype=np.float64)
        if self._loop is not None and self._loop[1] > self._loop[0]:
            start, stop = self._loop
            places = start + (places - start) % (stop - start)
        self._at = float(places[-1])
        return self._interpolated(places[:-1])

    def _interpolated(self, places: Array) -> Samples:
        """Return the recording at fractional places, zero outside; at whole ones exactly its samples."""
        whole = np.floor(places).astype(np.int64)
        part = (places - whole).astype(np.float32)[:, None]
        return self._taken(whole) * (1 - part) + (self._taken(whole + 1) * part if part.any() else 0)

    def _taken(self, places: npt.NDArray[np.int64]) -> Samples:
        inside = (places >= 0) & (places < len(self._samples))
        taken: Samples = self._samples[np.clip(places, 0, len(self._samples) - 1)] * inside[:, None].astype(np.float32)
        return taken

    def _fade(self, frames: int) -> Samples:
        """Return the gain of each sample, on its way to 1 or to 0."""
        goal = 1.0 if self._running and not self.muted else 0.0
        way = np.arange(1, frames + 1, dtype=np.float32) / (RAMP_S * self._out_rate)
        gains: Samples = np.minimum(self._gain + way, 1.0) if goal else np.maximum(self._gain - way, 0.0)
        self._gain = float(gains[-1])
        return gains

    def _start_grain(self, frames: int) -> None:
        """Let the waiting grain begin in this block, if the one before is half over by then."""
        if self._next_grain is None:
            return
        wait = max(0, self._half_grain() - self._grains[-1][1]) if self._grains else 0
        if wait < frames:
            self._grains.append((self._next_grain, -wait))
            self._next_grain = None

    def _half_grain(self) -> int:
        return round(GRAIN_S / 2 * self._out_rate)

    def _grainy(self, frames: int) -> Samples:
        length = 2 * self._half_grain()
        block = np.zeros((frames, self._samples.shape[1]), np.float32)
        for place, played in self._grains:
            age = np.arange(played, played + frames)
            window = np.where((age >= 0) & (age < length), 0.5 - 0.5 * np.cos(2 * np.pi * age / length), 0.0)
            block += window.astype(np.float32)[:, None] * self._interpolated(place + age * self._rate / self._out_rate)
        self._grains = [(place, played + frames) for place, played in self._grains if played + frames < length]
        return np.zeros_like(block) if self.muted else block
