"""Listening for a phone: one thread, a bounded queue that drops the oldest, loopback unless set otherwise."""

from __future__ import annotations

import errno
import select
import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engine.errors import EngineError
from engine.live.decode import MAX_DATAGRAM
from engine.live.stream import LiveFrame, Stream

PORT = 11111
LOOPBACK = "127.0.0.1"
QUEUE = 64  # datagrams waiting to be cleaned: half a second of the fastest phone
FRAMES = 512  # cleaned frames waiting to be shown
PER_S = 500.0  # datagrams a second of one sender that are read at all; a phone sends 60
SENDERS = 32  # that have an allowance of their own
SILENT_S = 10.0  # after which a sender's allowance makes room for another's
LISTEN_TO = "Use 127.0.0.1, or 0.0.0.0 to hear the whole network."
_POLL_S = 0.2  # how long closing may take
_LATENCIES = 1024


@dataclass(frozen=True)
class Status:
    """How a listener is doing, for a panel to show.

    Attributes
    ----------
    subjects : names heard so far
    frames : frames cleaned
    drops : how many datagrams were not used, by reason
    latency_p95_ms : from arrival to clean weights, over the last thousand frames; NaN before the first
    """

    subjects: tuple[str, ...]
    frames: int
    drops: dict[str, int]
    latency_p95_ms: float


class Allowances:
    """A token bucket for each sender: so many datagrams a second, with bursts of as many as the queue holds."""

    def __init__(self, per_s: float = PER_S, burst: int = QUEUE) -> None:
        self._per_s, self._burst = per_s, float(burst)
        self._left: dict[str, tuple[float, float]] = {}  # tokens, and when they were counted

    def take(self, sender: str, now_s: float) -> bool:
        """Return whether one more datagram of a sender may pass now; senders beyond `SENDERS` share one bucket.

        Whoever sent nothing for `SILENT_S` is forgotten when another needs the place.
        """
        if sender not in self._left and self._full():
            oldest = min((name for name in self._left if name), key=lambda name: self._left[name][1])
            if now_s - self._left[oldest][1] > SILENT_S:
                del self._left[oldest]
        key = sender if sender in self._left or not self._full() else ""
        left, last_s = self._left.get(key, (self._burst, now_s))
        left = min(self._burst, left + (now_s - last_s) * self._per_s)
        self._left[key] = (left - 1 if left >= 1 else left, now_s)
        return left >= 1

    def _full(self) -> bool:
        return len(self._left) - ("" in self._left) >= SENDERS  # the shared bucket is nobody's place


class Listener:
    """Receives, decodes and cleans on a thread of its own; use as a context, or call `close`.

    Parameters
    ----------
    stream : what the datagrams are handed to
    bind : address to listen on; other computers and phones are heard only when this is not loopback
    port : UDP port; 0 picks a free one
    on_frames : called on the listener's thread whenever there are new frames; must return at once

    Raises
    ------
    EngineError : when the port cannot be listened on
    """

    def __init__(
        self,
        stream: Stream,
        *,
        bind: str = LOOPBACK,
        port: int = PORT,
        on_frames: Callable[[], None] = lambda: None,
    ) -> None:
        self.stream, self._on_frames = stream, on_frames
        self._socket = _open(bind, port)
        self.address: tuple[str, int] = self._socket.getsockname()[:2]
        self._frames: deque[LiveFrame] = deque(maxlen=FRAMES)
        self._latencies: deque[float] = deque(maxlen=_LATENCIES)
        self._allowances = Allowances()
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="retake-live", daemon=True)
        self._thread.start()

    def __enter__(self) -> Listener:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stop listening and end the thread."""
        self._closing.set()
        self._thread.join(timeout=5)
        self._socket.close()

    def frames(self) -> list[LiveFrame]:
        """Return the frames cleaned since the last call, oldest first; of more than `FRAMES` the oldest are gone."""
        taken: list[LiveFrame] = []
        while True:
            try:
                taken.append(self._frames.popleft())
            except IndexError:
                return taken

    def status(self) -> Status:
        """Return counters and latency."""
        counts = dict(self.stream.counts)
        latencies = list(self._latencies)
        p95 = float(np.percentile(latencies, 95)) if latencies else float("nan")
        return Status(tuple(self.stream.subjects), counts.pop("frames", 0), counts, p95)

    def _run(self) -> None:
        waiting: deque[tuple[bytes, float]] = deque()
        while not self._closing.is_set():
            self._collect(waiting)
            while waiting:
                data, arrived_s = waiting.popleft()
                frame = self.stream.receive(data, arrived_s, time.perf_counter)
                if frame is not None:
                    self._frames.append(frame)
                    self._latencies.append(frame.latency_ms)
                    self._on_frames()

    def _collect(self, waiting: deque[tuple[bytes, float]]) -> None:
        """Wait for a datagram, then take what else has come; the oldest go where there is no room.

        Takes a few queues' worth at a time, so that a flood cannot keep the first from being cleaned.
        """
        if not select.select([self._socket], [], [], _POLL_S)[0]:
            return
        for _ in range(4 * QUEUE):
            try:
                data, sender = self._socket.recvfrom(MAX_DATAGRAM)
            except OSError:  # nothing left; on Windows also an ICMP error about an earlier packet
                return
            arrived_s = time.perf_counter()
            if not self._allowances.take(str(sender[0]), arrived_s):
                self.stream.counts["too many"] += 1
                continue
            if len(waiting) == QUEUE:
                waiting.popleft()
                self.stream.counts["too slow"] += 1
            waiting.append((data, arrived_s))


def _open(bind: str, port: int) -> socket.socket:
    try:
        family = socket.getaddrinfo(bind, port, type=socket.SOCK_DGRAM)[0][0]
        opened = socket.socket(family, socket.SOCK_DGRAM)
    except (OSError, OverflowError, UnicodeError) as error:
        raise EngineError(f"{bind}:{port} is no address to listen on.", LISTEN_TO) from error
    try:
        opened.bind((bind, port))
    except (OSError, OverflowError) as error:
        opened.close()
        if getattr(error, "errno", None) == errno.EADDRNOTAVAIL:
            raise EngineError(f"{bind} is no address of this computer.", LISTEN_TO) from error
        reason = getattr(error, "strerror", None) or "no such port"
        raise EngineError(
            f"Port {port} on {bind} cannot be listened on: {reason.lower()}.",
            "Close what else listens there, or choose another port.",
        ) from error
    opened.setblocking(False)
    return opened
