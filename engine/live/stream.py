"""One face's stream: datagrams in, cleaned frames out; no socket and no thread, so that it can be tested to the byte."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engine.clean.infer import Cleaner, CleanState, bundled, plausible
from engine.live.decode import decode
from engine.live.packet import Drop, Floats, Packet
from engine.take import SHAPES

MAX_SUBJECTS = 16  # names to choose from; a flood of invented ones must not fill memory
SILENT_S = 10.0  # after which a name may make room for another, and the face that is followed for one that sends
AHEAD_S = 10.0  # by which a sender's clock may run ahead of the time that has passed
RESTART_S = 10.0  # a leap of the sender's clock beyond this is a new beginning, not a gap
LATE_S = 2.0  # a frame older than this cannot be a reordered one: the sender's clock was set back
MAX_BRIDGE = 16  # frames of own motion put into one gap; more would delay the frame that ends it


@dataclass(frozen=True, eq=False)
class LiveFrame:
    """One frame, raw and clean.

    Attributes
    ----------
    time_s : since the stream began, on the sender's clock
    raw : (52,) float32 as sent; the last face while there is none
    clean : (52,) float32, 0..1
    rotations : (9,) float32, radians
    lost : whether the phone saw no face
    arrived_s : when the datagram arrived, on the clock that the listener reads
    latency_ms : from then until `clean` was ready
    """

    subject: str
    time_s: float
    fps: float
    raw: Floats
    clean: Floats
    rotations: Floats
    lost: bool
    arrived_s: float
    latency_ms: float


@dataclass(frozen=True, eq=False)
class Arrival:
    """A plausible packet with its place in time; what a recorder keeps, late ones too.

    Attributes
    ----------
    weights : (52,) float32; None where the phone saw no face or sent implausible weights
    late : whether a newer frame had come before it
    """

    time_s: float
    fps: float
    weights: Floats | None
    rotations: Floats
    late: bool


class Clock:
    """Puts packets in time by the sender's clock, which may leap, stand or be missing."""

    def __init__(self) -> None:
        self._shift: float | None = None  # what is added to the sender's time
        self._last, self._next = 0.0, 0.0
        self._begin_s: float | None = None  # when the first packet arrived

    def restart(self) -> None:
        """Let the next packet follow the last one, whatever its sender's clock says."""
        self._shift = None

    def place(self, packet: Packet, arrived_s: float) -> tuple[float, bool]:
        """Return time since the stream began, and whether a newer frame has come before."""
        stated = arrived_s if packet.time_s is None else packet.time_s
        if self._shift is None or not -LATE_S <= stated + self._shift - self._last <= RESTART_S:
            self._shift = self._next - stated
        time_s = stated + self._shift
        if self._begin_s is None:
            self._begin_s = arrived_s
        if time_s > max(arrived_s - self._begin_s + AHEAD_S, self._next):  # small leaps add up, and each would be a gap
            time_s = self._next
            self._shift = time_s - stated
        self._next = max(self._next, time_s + 1 / packet.fps)
        late = time_s < self._last
        self._last = max(self._last, time_s)
        return time_s, late


class Stream:
    """Decodes, chooses the subject, cleans, and counts what it could not use.

    Parameters
    ----------
    subject : whose face; None takes the first one that arrives
    strength : 0 gives the raw face, 1 the clean one; may be changed at any time
    on_arrival : called with every usable packet in the order of arrival, for a recorder
    """

    def __init__(
        self,
        *,
        subject: str | None = None,
        strength: float = 1.0,
        cleaner: Cleaner | None = None,
        on_arrival: Callable[[Arrival], None] | None = None,
    ) -> None:
        self.subject, self.strength, self.on_arrival = subject, strength, on_arrival
        self.counts: Counter[str] = Counter()
        self.subjects: list[str] = []
        self._heard: dict[str, tuple[int, float]] = {}  # by name: how often, and when last
        self._asked_for = subject is not None
        self._cleaner = cleaner or bundled()
        self._chosen: str | None = None
        self._clock = Clock()
        self._restart()

    def choose(self, subject: str) -> None:
        """Follow another subject from the next datagram on; may be called on any thread."""
        self._chosen = subject

    def _restart(self) -> None:
        self._clock.restart()
        self._state: CleanState | None = None
        self._raw: Floats = np.zeros(len(SHAPES), np.float32)
        self._time_s = 0.0

    def receive(self, data: bytes, arrived_s: float, now: Callable[[], float]) -> LiveFrame | None:
        """Take one datagram; returns the frame it gave, or None where it was dropped and counted. Never raises.

        Parameters
        ----------
        arrived_s : when it arrived, on the clock that `now` reads
        """
        if self._chosen is not None:
            self.subject, self._chosen, self._asked_for = self._chosen, None, True
            self._restart()
        decoded = decode(data)
        if isinstance(decoded, Drop):
            self.counts[decoded.value] += 1
            return None
        if not self._follows(decoded.subject, arrived_s):
            self.counts["another subject"] += 1
            return None
        arrival = self._arrival(decoded, arrived_s)
        if self.on_arrival is not None:
            self.on_arrival(arrival)
        if arrival.late or (self._state is not None and arrival.time_s == self._time_s):
            self.counts["late or doubled"] += 1
            return None
        return self._frame(arrival, decoded.subject, arrived_s, now)

    def _follows(self, subject: str, arrived_s: float) -> bool:
        """Return whether a subject is the one that is followed: the first, or another that sends where that fell silent.

        During a recording, and where the user chose, the subject stays.
        """
        self._hear(subject, arrived_s)
        if self.subject is None:
            self.subject = subject
        elif subject != self.subject and not self._asked_for and self.on_arrival is None:
            _, last_s = self._heard.get(self.subject, (0, -np.inf))
            if arrived_s - last_s > SILENT_S:
                self.subject = subject
                self._restart()
        return subject == self.subject

    def _hear(self, subject: str, arrived_s: float) -> None:
        """Count a name; where there are too many, the one that is silent makes room, else that heard least.

        Invented names are heard once each, so that none of them keeps a phone out that sends sixty times a second.
        """
        count, _ = self._heard.get(subject, (0, 0.0))
        if count == 0 and len(self._heard) >= MAX_SUBJECTS:
            others = [name for name in self._heard if name != self.subject]
            silent = [name for name in others if arrived_s - self._heard[name][1] > SILENT_S]
            self._heard.pop(min(silent or others, key=lambda name: self._heard[name]))
        self._heard[subject] = count + 1, arrived_s
        if count == 0:
            self.subjects = list(self._heard)  # a new list: others read it on threads of their own

    def _arrival(self, packet: Packet, arrived_s: float) -> Arrival:
        weights = packet.weights
        if weights is not None and plausible(weights) is None:
            self.counts["weights that no face has"] += 1
            weights = None
        time_s, late = self._clock.place(packet, arrived_s)
        return Arrival(time_s, packet.fps, weights, packet.rotations, late)

    def _frame(self, arrival: Arrival, subject: str, arrived_s: float, now: Callable[[], float]) -> LiveFrame | None:
        if arrival.weights is not None:
            self._raw = arrival.weights
        elif self._state is None:
            self.counts["no face yet"] += 1
            return None
        self._state = self._advance(arrival)
        self._time_s = arrival.time_s
        self.counts["frames"] += 1
        clean = (1 - self.strength) * self._raw + self.strength * self._state.output
        latency_ms = (now() - arrived_s) * 1e3
        lost = arrival.weights is None
        return LiveFrame(
            subject, arrival.time_s, arrival.fps, self._raw, clean, arrival.rotations, lost, arrived_s, latency_ms
        )

    def _advance(self, arrival: Arrival) -> CleanState:
        """Return the state after a frame; frames that never came are bridged by the face's own motion."""
        if self._state is None:
            return self._cleaner.start(self._raw)
        step = arrival.time_s - self._time_s
        missed = min(round(step * arrival.fps) - 1, MAX_BRIDGE) if step * arrival.fps >= 2.5 else 0
        state = self._state
        for _ in range(missed):
            state = self._cleaner.step(None, step / (missed + 1), state)
        return self._cleaner.step(arrival.weights, step / (missed + 1), state)
