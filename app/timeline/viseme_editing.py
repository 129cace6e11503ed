"""The visemes lane under the hand: boundaries are dragged, blocks named, all of it by one undo step each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from PySide6.QtCore import QObject, QPoint, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QPainter
from PySide6.QtWidgets import QLineEdit, QMenu, QWidget

from app.session import Session
from app.session.commands import VisemesCommand
from app.theme import Palette
from app.timeline.visemes import EDGE_PX, Place, VisemeStrip, choices, describe, icon
from engine.errors import EditError, EngineError
from engine.speech.lane import VisemeLane, renamed, shifted, with_boundary

ENTRY_PX = 150
SAYS = "a viseme or phone, or with its begin and end in seconds: AA1 2.40 2.55"
Edge = tuple[int | None, int | None]


@dataclass(frozen=True)
class _Drag:
    edge: Edge
    began_s: float
    before: VisemeLane
    lane: VisemeLane  # as it would be


class Entry(QLineEdit):
    """Typed into in place: Enter gives what was typed, Escape or a click elsewhere drops it."""

    given = Signal(str)
    closed = Signal()

    def __init__(self, parent: QWidget, text: str, hint: str) -> None:
        super().__init__(text, parent)
        self._gone = False
        self.setToolTip(hint)
        self.setAccessibleName(hint)
        self.setMaxLength(60)
        self.returnPressed.connect(self._give)

    def _give(self) -> None:
        text = self.text()
        self.close_entry()
        self.given.emit(text)

    def close_entry(self) -> None:
        """Hide; hiding loses the focus, which calls this once more."""
        if not self._gone:
            self._gone = True
            self.closed.emit()
            self.hide()
            self.deleteLater()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Drop what is typed on Escape."""
        if event.key() == Qt.Key.Key_Escape:
            self.close_entry()
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Drop what is typed when something else is worked on."""
        super().focusOutEvent(event)
        if event.reason() != Qt.FocusReason.PopupFocusReason:
            self.close_entry()


class VisemeEditing(QObject):
    """Draws the lane and turns what the mouse and the keys do there into undo steps.

    Parameters
    ----------
    session : whose visemes
    host : the widget that the lane is drawn on
    place : where on it
    """

    failed = Signal(str, str)  # sentence, advice
    wanted = Signal(str)  # the name of an action of the table

    def __init__(self, session: Session, host: QWidget, place: Callable[[], Place]) -> None:
        super().__init__(host)
        self._session, self._host, self._place = session, host, place
        self._strip = VisemeStrip()
        self._drag: _Drag | None = None
        self.entry: Entry | None = None
        self.menu: QMenu | None = None

    @property
    def dragging(self) -> bool:
        """Whether a boundary is held."""
        return self._drag is not None

    def draw(self, painter: QPainter, colours: Palette) -> None:
        """Draw the lane, with the boundary where it is held."""
        lane = self._session.document.visemes
        if lane is None:
            return
        painter.save()
        self._strip.draw(painter, lane, self._place(), colours)
        if self._drag is not None and self._drag.before is lane:
            moved = [index for index in self._drag.edge if index is not None]
            self._strip.draw_moved(painter, self._drag.lane, moved, self._place(), colours)
        painter.restore()

    def time_at(self, x: float) -> float:
        """Return the time of the take, s, at a place in the widget."""
        box, (first_s, last_s) = self._place()
        return first_s + (x - box.left()) / max(1.0, box.width()) * (last_s - first_s)

    def cue_at(self, x: float) -> int | None:
        """Return the cue under the pointer."""
        lane = self._session.document.visemes
        return lane.at(self.time_at(x)) if lane is not None else None

    def edge_at(self, x: float) -> Edge | None:
        """Return the boundary that a press at the pointer would grab."""
        lane, (box, (first_s, last_s)) = self._session.document.visemes, self._place()
        if lane is None:
            return None
        return lane.edge_near(self.time_at(x), EDGE_PX / max(1.0, box.width()) * (last_s - first_s))

    def tool_tip(self, x: float) -> str:
        """Return what to say of what lies under the pointer."""
        lane, index = self._session.document.visemes, self.cue_at(x)
        return describe(lane, index) if lane is not None and index is not None else ""

    # --- dragging a boundary

    def take(self, x: float) -> bool:
        """Grab the boundary under the pointer, if there is one."""
        lane, edge = self._session.document.visemes, self.edge_at(x)
        if lane is None or edge is None:
            return False
        self._drag = _Drag(edge, self.time_at(x), lane, lane)
        return True

    def move(self, x: float) -> None:
        """Show the boundary that is held at another place."""
        drag = self._drag
        if drag is None:
            return
        lane, (before, after) = drag.before, drag.edge
        was_s = lane.times_s[before, 1] if before is not None else lane.times_s[after, 0]
        # it moves as far as the pointer does, which rarely takes hold of its very middle
        moved = with_boundary(lane, before, after, float(was_s) + self.time_at(x) - drag.began_s)
        self._drag = replace(drag, lane=moved)
        self._host.update()

    def release(self) -> None:
        """Leave the boundary where it is: one undo step."""
        drag, self._drag = self._drag, None
        if drag is not None and drag.lane is not drag.before:
            self._push(drag.before, drag.lane, "move a viseme boundary")
        self._host.update()

    def drop(self) -> bool:
        """Cancel the move of a boundary and what is typed; returns whether there was any."""
        held, self._drag = self._drag is not None or self.entry is not None, None
        if self.entry is not None:
            self.entry.close_entry()
        self._host.update()
        return held

    # --- blocks

    def select(self, x: float) -> None:
        """Select the frames of the cue under the pointer."""
        lane, index = self._session.document.visemes, self.cue_at(x)
        if lane is not None and index is not None:
            self._session.view.select(lane.frames_of(index, self._session.document.take.fps))

    def open_menu(self, x: float, at: QPoint, colours: Palette) -> None:
        """Offer what the cue under the pointer could be instead, and what can be done with the lane."""
        lane, index = self._session.document.visemes, self.cue_at(x)
        if lane is None:
            return
        self.menu = menu = QMenu(self._host)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        if index is not None:
            for name, title in choices():
                menu.addAction(icon(name, colours), title).triggered.connect(partial(self._say, lane, index, name))
            menu.addSeparator()
            menu.addAction("Type…").triggered.connect(partial(self.type_name, index))
            menu.addAction("Shift all so that it begins at the playhead").triggered.connect(
                partial(self._begin_at_playhead, lane, index)
            )
        for name, title in (
            ("shift_visemes", "Shift all…"),
            ("restore_visemes", "All as attached"),
            ("remove_visemes", "Remove the visemes"),
        ):
            menu.addAction(title).triggered.connect(partial(self._want, name))
        menu.popup(at)

    def type_name(self, index: int, *_: bool) -> None:
        """Let a cue's name be typed, and its begin and end."""
        lane = self._session.document.visemes
        if lane is None:
            return
        (start_s, stop_s), label = lane.times_s[index], lane.cues[index].label.strip() or "sil"
        box, (first_s, last_s) = self._place()
        x = box.left() + (float(start_s) - first_s) / max(1e-9, last_s - first_s) * box.width()
        entry = self._open_entry(f"{label} {start_s:.3f} {stop_s:.3f}", SAYS, x)
        entry.setSelection(0, len(label))
        entry.given.connect(partial(self._say_typed, lane, index))

    def type_shift(self) -> None:
        """Let the time be typed at which the lane's file begins."""
        lane = self._session.document.visemes
        if lane is not None:
            hint = "seconds of the take at which the file of the visemes begins"
            entry = self._open_entry(f"{lane.offset_s:g}", hint, self._place()[0].left())
            entry.selectAll()
            entry.given.connect(partial(self._shift_typed, lane))

    def _open_entry(self, text: str, hint: str, x: float) -> Entry:
        box, _ = self._place()
        left = min(max(box.left(), x), box.right() - ENTRY_PX)
        self.entry = entry = Entry(self._host, text, hint)
        entry.setGeometry(int(left), int(box.top()) - 1, ENTRY_PX, int(box.height()) + 2)
        entry.closed.connect(self._forget_entry)
        entry.show()
        entry.setFocus()
        return entry

    def _forget_entry(self) -> None:
        self.entry = None

    def _say(self, lane: VisemeLane, index: int, label: str, *_: bool) -> None:
        self._push(lane, renamed(lane, index, label), f"say {label}")

    def _say_typed(self, lane: VisemeLane, index: int, text: str) -> None:
        try:
            self._push(lane, _as_typed(lane, index, text), f"say {text.split(maxsplit=1)[0]}")
        except EngineError as error:
            self.failed.emit(error.sentence, error.advice)

    def _shift_typed(self, lane: VisemeLane, text: str) -> None:
        try:
            self._push(lane, shifted(lane, _seconds(text)), "shift the visemes")
        except EngineError as error:
            self.failed.emit(error.sentence, error.advice)

    def _begin_at_playhead(self, lane: VisemeLane, index: int, *_: bool) -> None:
        by_s = self._session.view.playhead / self._session.document.take.fps - float(lane.times_s[index, 0])
        self._push(lane, shifted(lane, lane.offset_s + by_s), "shift the visemes")

    def _want(self, name: str, *_: bool) -> None:
        self.wanted.emit(name)

    def _push(self, before: VisemeLane, after: VisemeLane, title: str) -> None:
        """Push one undo step, unless the lane has changed since the boundary was grabbed."""
        if self._session.document.visemes is before:
            self._session.document.undo.push(VisemesCommand.of(self._session.document, after, title))


def _seconds(text: str) -> float:
    try:
        return float(text.strip().removesuffix("s"))
    except ValueError:
        raise EditError(f"{text.strip()[:40]!r} is not a number of seconds.") from None


def _as_typed(lane: VisemeLane, index: int, text: str) -> VisemeLane:
    """Return the lane with a cue as `NAME` or `NAME BEGIN END` says; raises `EditError` for anything else."""
    parts = text.split()
    if len(parts) not in (1, 3):
        raise EditError(f"{text.strip()[:40]!r} is not a viseme.", f"Type {SAYS}.")
    changed = renamed(lane, index, parts[0])
    if len(parts) == 1:
        return changed
    begin_s, end_s = _seconds(parts[1]), _seconds(parts[2])
    if not begin_s < end_s:
        raise EditError("A viseme must begin before it ends.")
    begin, end = (*changed.begin_of(index), begin_s), (*changed.end_of(index), end_s)
    later = begin_s > changed.times_s[index, 0]  # what moves on needs room before it
    for boundary in (end, begin) if later else (begin, end):
        changed = with_boundary(changed, *boundary)
    return changed
