"""The frames around the playhead, carried as soon as they are looked at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.retarget.carry import Carried, Carrier, Carry, Performance, Target
from engine.spacetime.matching import Matching
from engine.take import Array

BEFORE_FRAMES, AFTER_FRAMES = 8, 24  # of the playhead, that are carried: playing goes on while more is made
AHEAD_FRAMES = 12  # how near the end of what is known the playhead may come before more is asked for

Submit = Callable[[Callable[[], Any], Callable[[Any], None]], None]


@dataclass(frozen=True, eq=False)
class _Asked:
    """What was asked for last: for what, and which frames, half-open."""

    wish: tuple[object, ...] = ()
    frames: tuple[int, int] = (0, 0)


class LiveFrames:
    """Asks for frames and keeps those that came.

    Parameters
    ----------
    submit : has work done off the GUI thread and hands on what it returns
    wanted : tells whether what was carried is still to be seen
    drawn : is called when other frames are there
    """

    def __init__(self, submit: Submit, wanted: Callable[[Carry], bool], drawn: Callable[[], None]) -> None:
        self._submit, self._wanted, self._drawn = submit, wanted, drawn
        self._carrier = Carrier()
        self.forget()

    def forget(self) -> None:
        """Know no frame: another performance is carried."""
        self._known: Carried | None = None
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
        """Carry the frames around the playhead, where they are not known or asked for yet."""
        frames = len(performance.take)
        wish = (performance, target.places, target.head, matching)
        first, stop = self._asked.frames if self._asked.wish == wish else (0, 0)
        if first <= playhead < stop and (playhead + AHEAD_FRAMES < stop or stop == frames):
            return
        span = (max(0, playhead - BEFORE_FRAMES), min(frames, playhead + AFTER_FRAMES + 1))
        self._asked = _Asked(wish, span)
        carry = Carry(performance, target, matching, span)
        self._submit(lambda: self._carrier(carry, _nobody), lambda came: self._show(carry, came))

    def _show(self, carry: Carry, came: Carried) -> None:
        if self._wanted(carry):
            self._known = came
            self._drawn()


def _nobody(_: float) -> None:
    pass
