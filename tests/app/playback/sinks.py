"""Loudspeakers for tests."""

from __future__ import annotations

import numpy as np

from app.playback.clock import Pull

BLOCK = 256


class SimulatedSink:
    """A device in simulated time: `run` lets time pass, in which it takes a block whenever one has been played."""

    name = "simulated"

    def __init__(self, rate: int, *, latency_s: float = 0.1) -> None:
        self.rate, self.latency_s = rate, latency_s
        self.now = 100.0
        self.played: list[np.ndarray] = []
        self.present = True
        self.closed = False
        self._pull: Pull | None = None
        self._due = 0.0

    def time_s(self) -> float:
        return self.now

    def start(self, pull: Pull) -> bool:
        if self.present and self._pull is None:
            self._pull, self._due = pull, self.now
        return self.present

    def close(self) -> None:
        self._pull, self.closed = None, True

    @property
    def pulling(self) -> bool:
        return self._pull is not None

    def run(self, seconds: float) -> None:
        end = self.now + seconds
        while self._pull is not None and self.present and self._due <= end + 1e-12:
            self.now = max(self.now, self._due)
            block = self._pull(BLOCK, self._due + self.latency_s)
            if block is None:
                self._pull = None
                break
            self.played.append(block)
            self._due += BLOCK / self.rate
        self.now = end

    def sound(self) -> np.ndarray:
        return np.concatenate(self.played)
