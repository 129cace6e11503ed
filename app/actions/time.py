"""The actions that move through time and the view; none changes the take."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Signal

from app.playback.transport import Transport
from app.session import Session
from app.spans.filling import Filling


class TimeActions(QObject):
    """Each method is an action of the table.

    Parameters
    ----------
    session, transport, filling : what they work on; while a fill is chosen, the arrows go through its variants
    """

    message = Signal(str)  # what is wrong where one went

    def __init__(self, session: Session, transport: Transport, filling: Filling) -> None:
        super().__init__()
        self._session, self._transport, self._filling = session, transport, filling
        self.looping: Callable[[], bool] = lambda: False

    def play(self) -> None:
        """Play or pause."""
        self._transport.toggle()

    def play_forwards(self) -> None:
        """Play forwards, faster each time."""
        self._transport.faster(1)

    def play_backwards(self) -> None:
        """Play backwards, faster each time."""
        self._transport.faster(-1)

    def play_slowly(self) -> None:
        """Play forwards at half the speed, slower each time."""
        self._transport.slower(1)

    def play_backwards_slowly(self) -> None:
        """Play backwards at half the speed, slower each time."""
        self._transport.slower(-1)

    def stop(self) -> None:
        """Stand still."""
        self._transport.run(0.0)

    def loop(self) -> None:
        """Begin again at the end, or stop there."""
        self._transport.set_loop(self.looping())

    def next_frame(self) -> None:
        """Go one frame on, or to the next variant."""
        if self._filling.variants:
            self._filling.choose(self._filling.chosen + 1)
        else:
            self._session.view.move_playhead(self._session.view.playhead + 1)

    def previous_frame(self) -> None:
        """Go one frame back, or to the variant before."""
        if self._filling.variants:
            self._filling.choose(self._filling.chosen - 1)
        else:
            self._session.view.move_playhead(self._session.view.playhead - 1)

    def first_frame(self) -> None:
        """Go to the beginning."""
        self._session.view.move_playhead(0)

    def last_frame(self) -> None:
        """Go to the end."""
        self._session.view.move_playhead(len(self._session.document.take) - 1)

    def next_span(self) -> None:
        """Go to the next flag, or to the next span and choose it."""
        later = [stop for stop in self._stops() if stop[0] > self._session.view.playhead]
        self._go_to(min(later, key=lambda stop: stop[0], default=None))

    def previous_span(self) -> None:
        """Go to the flag before, or to the span before and choose it."""
        earlier = [stop for stop in self._stops() if stop[0] < self._session.view.playhead]
        self._go_to(max(earlier, key=lambda stop: stop[0], default=None))

    def _stops(self) -> list[tuple[int, tuple[int, int] | None]]:
        """Return the frames to stop at, each with what to select there: spans, and flags that begin at none."""
        spans = {span.start: (span.start, span.stop) for span in self._session.document.marks.spans}
        flags = {flag.start for flag in self._session.document.flags or ()}
        return [*spans.items(), *((frame, None) for frame in flags - set(spans))]

    def _go_to(self, stop: tuple[int, tuple[int, int] | None] | None) -> None:
        if stop is None:
            return
        frame, chosen = stop
        within = self._session.view.selection
        if chosen is not None:
            self._session.view.select(chosen)
        elif within is not None and not within[0] <= frame < within[1]:
            self._session.view.select(None)  # else playing from the flag would leap back into the selection
        self._session.view.move_playhead(frame)
        found = [flag for flag in self._session.document.flags or () if flag.start == frame]
        self.message.emit(max(found, key=lambda flag: flag.weight).sentence if found else "")

    def set_in(self) -> None:
        """Let the selection begin at the playhead."""
        _, stop = self._session.view.selection or (0, len(self._session.document.take))
        self._session.view.select((self._session.view.playhead, max(stop, self._session.view.playhead + 1)))

    def set_out(self) -> None:
        """Let the selection end at the playhead."""
        start, _ = self._session.view.selection or (0, 0)
        self._session.view.select((min(start, self._session.view.playhead), self._session.view.playhead + 1))

    def clear_selection(self) -> None:
        """Select nothing."""
        self._session.view.select(None)

    def frame_all(self) -> None:
        """Show the whole take."""
        self._session.view.set_range(0.0, len(self._session.document.take) - 1.0)

    def zoom_in(self) -> None:
        """Show fewer frames around the playhead."""
        self._session.view.zoom(1.5, self._session.view.playhead)

    def zoom_out(self) -> None:
        """Show more frames around the playhead."""
        self._session.view.zoom(1 / 1.5, self._session.view.playhead)

    def next_lane(self) -> None:
        """Work on the next curve."""
        self._step_lane(1)

    def previous_lane(self) -> None:
        """Work on the curve before."""
        self._step_lane(-1)

    def _step_lane(self, by: int) -> None:
        lanes = self._session.view.lanes
        at = lanes.index(self._session.view.lane) + by
        if 0 <= at < len(lanes):
            self._session.view.choose_lane(lanes[at])

    def expand_lane(self) -> None:
        """Show the weights under the active control, or put them away."""
        self._session.view.expand(self._session.view.lane)
