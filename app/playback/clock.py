"""The playback clock: follows the sound device, or the wall clock where there is none."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Protocol

from app.playback.source import Loop, Source, looped
from engine.formats.audio import Audio, Samples

STALL_S = 0.5  # a loudspeaker that asks for nothing for so long has been unplugged
REST_S = 1.0  # with nothing to play for so long it may rest

Pull = Callable[[int, float], "Samples | None"]  # frames, when the first is heard -> (frames, channels); None: rest


class Clock(Protocol):
    """Time in the take; all times in seconds from its first frame."""

    def play(self, at_s: float, speed: float, loop: Loop | None) -> None:
        """Run from a time at a speed, round and round where there is a loop."""

    def stop(self) -> None:
        """Stand still."""

    def now_s(self) -> float:
        """Return the time that is seen and heard now."""

    def scrub(self, at_s: float) -> None:
        """Let a moment be heard while standing still."""

    def close(self) -> None:
        """Release the device; the clock is not used after."""


class Sink(Protocol):
    """A loudspeaker: pulls blocks from a thread of its own, at its own pace."""

    rate: int  # Hz, which may differ from the recording's
    name: str  # as the system calls it

    def start(self, pull: Pull) -> bool:
        """Pull until `pull` returns None; nothing where it pulls already; False where the device has gone."""

    def close(self) -> None:
        """Stop pulling; returns when no call is under way."""


class WallClock:
    """Time by the computer's clock.

    Parameters
    ----------
    time_s : monotone seconds
    """

    def __init__(self, time_s: Callable[[], float] = time.perf_counter) -> None:
        self._time_s = time_s
        self._since_s = self._from_s = self._speed = 0.0
        self._loop: Loop | None = None

    def play(self, at_s: float, speed: float, loop: Loop | None) -> None:
        """Run from a time."""
        self._since_s, self._from_s, self._speed, self._loop = self._time_s(), at_s, speed, loop

    def stop(self) -> None:
        """Stand still."""
        self.play(self.now_s(), 0.0, None)

    def now_s(self) -> float:
        """Return the time since `play`, times the speed."""
        return looped(self._from_s + (self._time_s() - self._since_s) * self._speed, self._loop)

    def scrub(self, at_s: float) -> None:
        """Say nothing."""

    def close(self) -> None:
        """Hold nothing."""


class AudioClock:
    """Time by the sound that is heard: the picture follows it, never the reverse.

    Parameters
    ----------
    audio, offset_s : the recording, and the time in the take at which it begins
    sink : the loudspeaker
    time_s : monotone seconds, in which the sink tells when a block is heard
    """

    def __init__(
        self, audio: Audio, offset_s: float, sink: Sink, time_s: Callable[[], float] = time.perf_counter
    ) -> None:
        self._sink, self._time_s = sink, time_s
        self._source = Source(audio, offset_s=offset_s, out_rate=sink.rate)
        self._offset_s = offset_s
        self._wall = WallClock(time_s)
        self._at_s = self._speed = self._idle_s = self._since_s = 0.0
        self._loop: Loop | None = None
        self._deaf = False  # nothing is heard: the wall tells the time until the next `play`
        self.scrubs = True  # whether moments are heard while standing still

    @property
    def muted(self) -> bool:
        """Whether the sound is off; time runs on."""
        return self._source.muted

    @muted.setter
    def muted(self, on: bool) -> None:
        self._source.muted = on

    def play(self, at_s: float, speed: float, loop: Loop | None) -> None:
        """Run from a time; backwards where the speed is negative, higher or lower where it is not 1."""
        self._at_s, self._speed, self._loop = at_s, speed, loop
        self._source.play(at_s, speed, loop)
        self._deaf = bool(speed) and not self._sink.start(self._pull)
        self._since_s = self._time_s()
        if self._deaf:
            self._wall.play(at_s, speed, loop)

    def shift(self, offset_s: float) -> None:
        """Let the sound begin at another time in the take, without letting go of the device."""
        if offset_s == self._offset_s:
            return
        at_s = self.now_s()
        self._offset_s = offset_s
        self._source.shift(offset_s)
        if self._speed:
            self.play(at_s, self._speed, self._loop)

    def stop(self) -> None:
        """Stand still, with the sound faded out."""
        self._at_s, self._speed, self._deaf = self.now_s(), 0.0, False
        self._source.stop()

    def now_s(self) -> float:
        """Return the time that is heard now; what has been pulled but waits in the device does not count."""
        if not self._speed:
            return self._at_s
        if self._deaf:
            return self._wall.now_s()
        now = self._time_s()
        heard_s, heard_until = self._source.heard(now)
        at_s = self._at_s if heard_s is None else heard_s
        if now - max(heard_until, self._since_s) > STALL_S:
            self._deaf = True
            self._wall.play(at_s, self._speed, self._loop)
        return at_s

    def scrub(self, at_s: float) -> None:
        """Let a moment be heard."""
        self._at_s = at_s
        if self.scrubs:
            self._source.scrub(at_s)
            self._sink.start(self._pull)

    def close(self) -> None:
        """Release the device."""
        self._sink.close()

    def _pull(self, frames: int, heard_from: float) -> Samples | None:
        self._idle_s = self._idle_s + frames / self._sink.rate if self._source.idle else 0.0
        if self._idle_s > REST_S:
            self._idle_s = 0.0
            return None
        return self._source.pull(frames, heard_from)
