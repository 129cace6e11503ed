"""Playback: the clock decides the frame, so that a slow picture drops frames and never time."""

from __future__ import annotations

import time

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from app.session import Session

TICKS_HZ = 60
SPEEDS = (1.0, 2.0, 4.0)


class Transport(QObject):
    """Moves the playhead in real time.

    Parameters
    ----------
    session : whose playhead moves
    """

    changed = Signal()  # playing, speed or loop

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.speed = 0.0  # takes per take: 1 is real time, negative runs backwards, 0 stands
        self.loop = False
        self._since, self._from = 0.0, 0
        self._timer = QTimer(self, interval=round(1000 / TICKS_HZ))
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._tick)

    @property
    def playing(self) -> bool:
        """Whether time runs."""
        return self.speed != 0.0

    def toggle(self) -> None:
        """Play or pause; at the end begin again."""
        if self.playing:
            self.run(0.0)
            return
        start, stop = self._range()
        if not start <= self._session.playhead < stop - 1:
            self._session.move_playhead(start)
        self.run(1.0)

    def faster(self, direction: int) -> None:
        """Play forwards (1) or backwards (-1); again for twice as fast."""
        if self.speed * direction <= 0:
            self.run(SPEEDS[0] * direction)
        else:
            at = SPEEDS.index(abs(self.speed)) if abs(self.speed) in SPEEDS else 0
            self.run(SPEEDS[min(at + 1, len(SPEEDS) - 1)] * direction)

    def run(self, speed: float) -> None:
        """Play at a speed; 0 stands still."""
        self.speed = speed
        self._since, self._from = time.perf_counter(), self._session.playhead
        if speed:
            self._timer.start()
        else:
            self._timer.stop()
        self.changed.emit()

    def set_loop(self, on: bool) -> None:
        """Begin again at the end, or stop there."""
        self.loop = on
        self.changed.emit()

    def _range(self) -> tuple[int, int]:
        return self._session.selection or (0, len(self._session.take))

    def _tick(self) -> None:
        elapsed = time.perf_counter() - self._since
        frame = self._from + int(elapsed * self._session.take.fps * self.speed)
        start, stop = self._range() if self.loop or self._session.selection else (0, len(self._session.take))
        if start <= frame < stop:
            self._session.move_playhead(frame)
            return
        if self.loop and stop - start > 1:
            self._session.move_playhead(start if self.speed > 0 else stop - 1)
            self.run(self.speed)
        else:
            self._session.move_playhead(stop - 1 if self.speed > 0 else start)
            self.run(0.0)
