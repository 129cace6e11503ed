"""The automatic findings: what is wrong at the playhead, and all others in a list to click."""

from __future__ import annotations

from collections import Counter

from PySide6.QtCore import QPoint, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QListWidget, QListWidgetItem

from app.session import Change, Session
from app.widgets.section import Section, quiet
from app.widgets.text import Label, tip
from engine.quality import KINDS, Flag
from engine.take import timecode
from engine.words import counted

LIST_PX = 104
LISTED = 1000  # flags; nobody clicks through more, and the lane has them all
NONE, LOOKING = "Nothing was found.", "Looking…"


class FlagsSection(Section):
    """Says what is wrong at the playhead and lists every flag in the order of time; a click goes there.

    Parameters
    ----------
    session : whose flags are shown

    Attributes
    ----------
    here : what is wrong at the playhead
    list : the flags, one a row
    """

    menu_wanted = Signal(QPoint)  # on the screen, after the playhead went to the flag

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Flags")
        self._flags: tuple[Flag, ...] = ()
        self.here, self.count, self.list = Label(), quiet(""), QListWidget()
        self.here.setWordWrap(True)
        self.list.setFixedHeight(LIST_PX)
        self.list.setAccessibleName("Flags")
        self.list.setUniformItemSizes(True)
        self.list.itemClicked.connect(self._go_to)
        self.list.itemActivated.connect(self._go_to)
        self.list.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.list.customContextMenuRequested.connect(self._open_menu)
        for widget in (self.here, self.count, self.list):
            self.column.addWidget(widget)
        session.changed.connect(self._on_change)
        self._list_all()

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.FLAGS):
            self._list_all()
        elif change & Change.PLAYHEAD:
            self._show_here()

    def _list_all(self) -> None:
        found, fps = self.session.document.flags, self.session.document.take.fps
        self._flags = (found or ())[:LISTED]
        with QSignalBlocker(self.list):
            self.list.clear()
            for flag in self._flags:
                item = QListWidgetItem(f"{timecode(flag.start / fps, fps)}  {KINDS[flag.kind]}", self.list)
                item.setToolTip(tip(flag.sentence))
        self.list.setVisible(bool(self._flags))
        self.count.setText(LOOKING if found is None else _summary(found) if found else NONE)
        self._show_here()

    def _show_here(self) -> None:
        """Tell what is wrong at the playhead, the heaviest first, and mark its row."""
        frame = self.session.view.playhead
        here = [row for row, flag in enumerate(self._flags) if flag.start <= frame < flag.stop]
        here.sort(key=lambda row: (self._flags[row].start != frame, -self._flags[row].weight))
        self.here.setText("\n".join(self._flags[row].sentence for row in here[:2]))
        self.here.setVisible(bool(here))
        with QSignalBlocker(self.list):
            self.list.setCurrentRow(here[0] if here else -1)

    def _go_to(self, item: QListWidgetItem) -> None:
        flag = self._flags[self.list.row(item)]
        self.session.view.move_playhead(flag.start)

    def _open_menu(self, at: QPoint) -> None:
        item = self.list.itemAt(at)
        if item is not None:
            self._go_to(item)
            self.menu_wanted.emit(self.list.viewport().mapToGlobal(at))


def _summary(flags: tuple[Flag, ...]) -> str:
    """Return how many flags there are, and of what kinds."""
    kinds = Counter(KINDS[flag.kind] for flag in flags)
    shown = ", ".join(f"{kind} {count:,}" for kind, count in kinds.most_common(3))
    more = f"; the first {LISTED:,} are listed" if len(flags) > LISTED else ""
    return f"{counted(len(flags), 'finding')}: {shown}{more}"
