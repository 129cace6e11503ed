"""Playback: the clock decides the frame, so that a slow picture drops frames and never time."""

from __future__ import annotations

import math

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from app.playback.clock import Clock, WallClock
from app.session import Change, Session

TICKS_HZ = 60
SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0)
ROUNDING_FRAMES = 0.01  # a clock that counts samples may be half a sample short of the frame it was sent to


class Transport(QObject):
    """Moves the playhead as a clock says.

    Parameters
    ----------
    session : whose playhead moves
    clock : the wall's without one
    """

    changed = Signal()  # playing, speed or loop

    def __init__(self, session: Session, clock: Clock | None = None) -> None:
        super().__init__()
        self._session = session
        self.clock: Clock = clock or WallClock()
        self.speed = 0.0  # takes per take: 1 is real time, negative runs backwards, 0 stands
        self.loop = False
        self._moving = False  # the playhead is moved from here
        self._timer = QTimer(self, interval=round(1000 / TICKS_HZ))
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self.tick)
        session.changed.connect(self._on_change)

    @property
    def playing(self) -> bool:
        """Whether time runs."""
        return self.speed != 0.0

    def use(self, clock: Clock) -> None:
        """Take the time from another clock, from where the playhead is; the old one is closed."""
        old, self.clock = self.clock, clock
        old.close()
        if self.playing:
            self._begin()

    def toggle(self) -> None:
        """Play or pause; at the end begin again."""
        if self.playing:
            self.run(0.0)
            return
        start, stop = self._range()
        if not start <= self._session.view.playhead < stop - 1:
            self._move(start)
        self.run(1.0)

    def faster(self, direction: int) -> None:
        """Play forwards (1) or backwards (-1); again for twice as fast."""
        self._step(direction, 1, first=1.0)

    def slower(self, direction: int) -> None:
        """Play forwards (1) or backwards (-1) at half the speed; again for half of that."""
        self._step(direction, -1, first=0.5)

    def _step(self, direction: int, by: int, *, first: float) -> None:
        """Play in a direction at a first speed, or by a step faster or slower where it plays there already."""
        if self.speed * direction <= 0:
            self.run(first * direction)
        else:
            at = SPEEDS.index(abs(self.speed)) if abs(self.speed) in SPEEDS else SPEEDS.index(1.0)
            self.run(SPEEDS[min(max(at + by, 0), len(SPEEDS) - 1)] * direction)

    def run(self, speed: float) -> None:
        """Play at a speed; 0 stands still."""
        self.speed = speed
        if speed:
            self._begin()
            self._timer.start()
        else:
            self.clock.stop()
            self._timer.stop()
        self.changed.emit()

    def set_loop(self, on: bool) -> None:
        """Begin again at the end, or stop there."""
        self.loop = on
        if self.playing:
            self._begin()
        self.changed.emit()

    def tick(self) -> None:
        """Go to the frame that the clock is at; frames it has passed are dropped."""
        start, stop = self._range()
        at = self.clock.now_s() * self._session.document.take.fps
        frame = math.floor(at + ROUNDING_FRAMES) if self.speed > 0 else math.ceil(at - ROUNDING_FRAMES)
        if self._looping():
            frame = min(max(frame, start), stop - 1)
        if start <= frame < stop:
            self._move(frame)
        else:
            self._move(stop - 1 if self.speed > 0 else start)
            self.run(0.0)

    def _range(self) -> tuple[int, int]:
        return self._session.view.selection or (0, len(self._session.document.take))

    def _looping(self) -> bool:
        start, stop = self._range()
        return self.loop and stop - start > 1

    def _begin(self) -> None:
        """Send the clock to the playhead, which is brought into the range."""
        start, stop = self._range()
        if not start <= self._session.view.playhead < stop:
            self._move(start if self.speed > 0 else stop - 1)
        fps = self._session.document.take.fps
        self.clock.play(
            self._session.view.playhead / fps, self.speed, (start / fps, stop / fps) if self._looping() else None
        )

    def _move(self, frame: int) -> None:
        self._moving = True
        try:
            self._session.view.move_playhead(frame)
        finally:
            self._moving = False

    def _on_change(self, change: Change) -> None:
        """Follow a playhead or range that someone else moved: play on from there, or let it be heard."""
        if self._moving:
            return
        if self.playing and change & (Change.PLAYHEAD | Change.SELECTION):
            self._begin()
        elif change & Change.PLAYHEAD:
            self.clock.scrub(self._session.view.playhead / self._session.document.take.fps)
