"""The sound of a movie: what a recording holds while its pictures are shown, in blocks, silence where it holds nothing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from engine.formats.audio import Audio, Samples

BLOCK_S = 0.25


@dataclass(frozen=True, eq=False)
class Soundtrack:
    """A recording beside a take.

    Attributes
    ----------
    audio : the recording
    offset_s : time of the take at which it begins
    """

    audio: Audio
    offset_s: float = 0.0

    @property
    def channels(self) -> int:
        """Number of channels, 1 or 2."""
        return self.audio.channels

    @property
    def rate(self) -> int:
        """Samples per second."""
        return self.audio.rate

    def blocks(self, from_s: float, lasting_s: float) -> Iterator[Samples]:
        """Yield what is heard from a time of the take on, (n, channels) float32 each, `lasting_s` seconds in all."""
        first, count = round((from_s - self.offset_s) * self.rate), round(lasting_s * self.rate)
        size = max(1, round(BLOCK_S * self.rate))
        for at in range(0, count, size):
            yield self._between(first + at, first + min(count, at + size))

    def _between(self, start: int, stop: int) -> Samples:
        """Return the samples start to stop, (stop - start, channels), zero where the recording has none."""
        samples = self.audio.samples
        found = np.zeros((stop - start, self.channels), np.float32)
        first, last = np.clip([start, stop], 0, len(samples))
        found[first - start : last - start] = np.asarray(samples[first:last]).reshape(-1, self.channels)
        return found
