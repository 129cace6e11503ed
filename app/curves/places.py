"""Where the lanes are: their places follow from the panel's size alone, and change only while no button is held."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from PySide6.QtCore import QAbstractAnimation, QEasingCurve, QObject, QRectF, QSizeF, QVariantAnimation, Signal

from app.theme import GRID

GUTTER_PX = 150
GAP_PX = 6  # between two lanes
ACTIVE_SHARE, SHARE = 2.4, 1.0  # of the height, for the lane that is worked on and for each other
GROW_MS = 140  # long enough that the eye can follow the lanes, short enough that nobody waits

Shares = Mapping[int, float]


def boxes(size: QSizeF, keys: Sequence[int], shares: Shares) -> list[QRectF]:
    """Return the box of each lane right of the gutter, from top to bottom, as wide as the panel lets it be.

    The height that the gaps leave is divided by the shares. Edges are on whole pixels, or lines would blur.
    """
    width = max(1.0, float(int(size.width()) - GUTTER_PX - GRID))
    left = max(float(len(keys)), size.height() - GAP_PX * (len(keys) - 1))
    whole, found, below = sum(shares[key] for key in keys), [], 0.0
    for row, key in enumerate(keys):
        top, below = round(below), below + left * shares[key] / whole
        found.append(QRectF(GUTTER_PX, top + GAP_PX * row, width, max(1, round(below) - top)))
    return found


class Growth(QObject):
    """The lanes' shares of the height: the chosen one grows and the one before shrinks, so slowly that it can be seen.

    While it is held still nothing moves: what lies under the pointer stays there until the button is let go.

    Attributes
    ----------
    shares : by lane, as they are now
    """

    moved = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.shares: dict[int, float] = {}
        self._from: dict[int, float] = {}
        self._wanted: dict[int, float] = {}
        self._held = False
        self._run = QVariantAnimation(self, startValue=0.0, endValue=1.0, duration=GROW_MS)
        self._run.setEasingCurve(QEasingCurve.Type.InOutCubic)
        self._run.valueChanged.connect(self._step)

    @property
    def moving(self) -> bool:
        """Whether lanes are on their way."""
        return self._run.state() == QAbstractAnimation.State.Running

    def choose(self, keys: Sequence[int], active: int, *, at_once: bool) -> None:
        """Let one of the lanes be the larger one; other lanes than before are at their places at once."""
        self._wanted = {key: ACTIVE_SHARE if key == active else SHARE for key in keys}
        if set(keys) != set(self.shares) or (at_once and not self._held):
            self._run.stop()
            self.shares = dict(self._wanted)
            self.moved.emit()
        elif not self._held:
            self._go()

    def hold(self) -> None:
        """Keep everything where it is until `release`."""
        self._held = True
        self._run.stop()

    def release(self) -> None:
        """Go on to what was wanted meanwhile."""
        self._held = False
        self._go()

    def _go(self) -> None:
        if self.shares != self._wanted:
            self._run.stop()
            self._from = dict(self.shares)
            self._run.start()

    def _step(self, done: float) -> None:
        if self._held or set(self._from) != set(self._wanted):
            return
        if done >= 1.0:
            self.shares = dict(self._wanted)
        else:
            self.shares = {
                key: self._from[key] + done * (wanted - self._from[key]) for key, wanted in self._wanted.items()
            }
        self.moved.emit()
