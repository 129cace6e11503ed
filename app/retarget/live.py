"""Retargets the frames around the playhead as soon as they are shown."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.retarget.solving import KIND
from app.retarget.target import Target
from app.session.asked import Asked
from app.session.edits import Runner
from engine.editing import Matching, Performance, Retargeted
from engine.take import Array

BEFORE_FRAMES, AFTER_FRAMES = 8, 24  # of the playhead, that are carried: playing goes on while more is made
AHEAD_FRAMES = 12  # how near the end of what is known the playhead may come before more is asked for


@dataclass(frozen=True, eq=False)
class _Asked:
    """What was asked for last: for what, and which frames, half-open."""

    wish: tuple[object, ...] = ()
    frames: tuple[int, int] = (0, 0)


class LiveFrames:
    """Asks for frames and keeps those that came.

    Parameters
    ----------
    runner : carries what is asked out, off the GUI thread
    wanted : tells whether what was carried is still to be seen
    drawn : is called when other frames are there
    """

    def __init__(self, runner: Runner, wanted: Callable[[Asked], bool], drawn: Callable[[], None]) -> None:
        self._runner, self._wanted, self._drawn = runner, wanted, drawn
        runner.arrived.connect(self._show)
        self.forget()

    def forget(self) -> None:
        """Forget every frame: the performance is another one."""
        self._known: Retargeted | None = None
        self._asked = _Asked()

    def ask_anew(self) -> None:
        """Let the next wish be asked for even where it is the last one again."""
        self._asked = _Asked()

    def face_at(self, frame: int) -> Array | None:
        """Return the weights, (52,), of the known frame that is nearest; None where none is known."""
        if self._known is None:
            return None
        known = self._known
        return known.weights_at(int(np.clip(frame, known.start, known.start + len(known.take) - 1)))

    def ask(self, performance: Performance, target: Target, matching: Matching, *, playhead: int) -> None:
        """Retarget the frames around the playhead that are not known yet."""
        frames = len(performance.take)
        wish = (performance, target.places, target.head, matching)
        first, stop = self._asked.frames if self._asked.wish == wish else (0, 0)
        if first <= playhead < stop and (playhead + AHEAD_FRAMES < stop or stop == frames):
            return
        span = (max(0, playhead - BEFORE_FRAMES), min(frames, playhead + AFTER_FRAMES + 1))
        self._asked = _Asked(wish, span)
        self._runner.ask(Asked(KIND, target.request(matching, span), performance))

    def _show(self, asked: Asked, came: Retargeted) -> None:
        if self._wanted(asked):
            self._known = came
            self._drawn()
