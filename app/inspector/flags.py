"""The automatic findings: what is wrong at the playhead, all others in a list to click, and those that were dismissed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace

from PySide6.QtCore import QEvent, QObject, QPoint, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QLineEdit, QListWidget, QListWidgetItem, QPushButton

from app.session import Change, Session
from app.session.commands import MarkCommand
from app.widgets.section import Section, quiet
from app.widgets.text import Label, tip
from app.widgets.times import signed
from engine.project import stamp
from engine.quality import KINDS, Dismissal, Flag, dismissal_of
from engine.take import timecode
from engine.words import SENTENCE_LENGTH, counted, plain

LIST_PX = 104
LISTED = 1000  # flags; nobody clicks through more, and the lane has them all
LONGEST = 400  # characters of a reason
NONE, LOOKING = "Nothing was found.", "Looking…"
NO_FLAG, HOW = "There is no finding on this frame.", "Up and Down go from one to the next."


class FlagsSection(Section):
    """Says what is wrong at the playhead and lists every flag in the order of time; a click goes there.

    Parameters
    ----------
    session : whose flags are shown

    Attributes
    ----------
    here : what is wrong at the playhead
    list : the flags, one a row, then those that were dismissed
    author : who dismisses
    """

    menu_wanted = Signal(QPoint)  # on the screen, after the playhead went to the flag
    failed = Signal(str, str)  # sentence, advice
    wanted = Signal(str)  # the name of an action

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Flags")
        self.author: Callable[[], str] = str
        self._flags: tuple[Flag, ...] = ()
        self._open = 0  # how many of them count
        self._dismissing: Flag | None = None
        self.here, self.count, self.list = Label(), quiet(""), QListWidget()
        self.here.setWordWrap(True)
        self.list.setFixedHeight(LIST_PX)
        self.list.setAccessibleName("Flags")
        self.list.setUniformItemSizes(True)
        self.list.itemClicked.connect(self._go_to)
        self.list.itemActivated.connect(self._go_to)
        self.list.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.list.customContextMenuRequested.connect(self._open_menu)
        self.why = QLineEdit()
        self.why.setMaxLength(LONGEST)
        self.why.setPlaceholderText("Why is it all right? Then Enter")
        self.why.setAccessibleName("Why this finding does not count")
        self.why.returnPressed.connect(self._typed)
        self.why.installEventFilter(self)
        self.why.hide()
        for widget in (self.here, self.count, self.list, self.why):
            self.column.addWidget(widget)
        self._dismiss = self._button("Dismiss…", "dismiss_flag")
        self._restore = self._button("Count it again", "restore_flag")
        self.side_by_side(self._dismiss, self._restore, self._button("What counts…", "flag_settings"))
        session.changed.connect(self._on_change)
        self._list_all()

    def _button(self, title: str, action: str) -> QPushButton:
        button = QPushButton(title)
        button.clicked.connect(lambda: self.wanted.emit(action))
        return button

    # --- dismissing

    def begin_dismissing(self) -> None:
        """Let it be typed why the finding at the playhead does not count."""
        found = [flag for flag in self._here() if flag in self._flags[: self._open]]
        if not found:
            self.failed.emit(NO_FLAG, HOW)
            return
        self._dismissing = found[0]
        self.why.clear()
        self.why.show()
        self.why.setFocus()

    def restore(self) -> None:
        """Let the finding at the playhead that was dismissed count again."""
        marks = self.session.document.marks
        gone = [flag for flag in self._here() if flag in self._flags[self._open :]]
        if not gone:
            self.failed.emit("No finding was dismissed on this frame.", "The list of flags has them at its end.")
            return
        kept = tuple(each for each in marks.dismissals if not each.covers(gone[0]))
        self._put(kept, f"count again: {KINDS[gone[0].kind]}")

    def _typed(self) -> None:
        flag, why = self._dismissing, self.why.text().strip()
        if flag is None or not why:
            return  # who dismisses something says why
        self._end_dismissing()
        dismissal = Dismissal(flag.kind, flag.start, flag.stop, flag.weight, flag.sentence, self.author(), stamp(), why)
        self._put((*self.session.document.marks.dismissals, dismissal), f"dismiss: {KINDS[flag.kind]}")

    def _put(self, dismissals: tuple[Dismissal, ...], title: str) -> None:
        document = self.session.document
        document.undo.push(MarkCommand.of(document, replace(document.marks, dismissals=dismissals), title))

    def _end_dismissing(self) -> None:
        self._dismissing = None
        self.why.clearFocus()
        self.why.hide()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Leave a finding as it is on Escape."""
        if self._dismissing is not None and isinstance(event, QKeyEvent) and event.key() == Qt.Key.Key_Escape:
            if event.type() == QEvent.Type.ShortcutOverride:
                event.accept()
                return True
            if event.type() == QEvent.Type.KeyPress:
                self._end_dismissing()
                return True
        return False

    # --- the list

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE and self._dismissing is not None:
            self._end_dismissing()
        if change & (Change.TAKE | Change.FLAGS):
            self._list_all()
        elif change & Change.PLAYHEAD:
            self._show_here()

    def _list_all(self) -> None:
        document = self.session.document
        found, fps = document.flags, document.take.fps
        counting = (found or ())[:LISTED]
        self._open, self._flags = len(counting), (*counting, *document.dismissed[:LISTED])
        with QSignalBlocker(self.list):
            self.list.clear()
            for row, flag in enumerate(self._flags):
                mark = "" if row < self._open else "✓ dismissed: "
                item = QListWidgetItem(f"{timecode(flag.start / fps, fps)}  {mark}{KINDS[flag.kind]}", self.list)
                item.setToolTip(tip(self._sentence(row)))
        self.list.setVisible(bool(self._flags))
        summary = LOOKING if found is None else _summary(found) if found else NONE
        gone = len(document.dismissed)
        self.count.setText(f"{summary} {counted(gone, 'finding')} dismissed." if gone else summary)
        self._show_here()

    def _sentence(self, row: int) -> str:
        """Return what is wrong, and who does not mind."""
        flag = self._flags[row]
        by = dismissal_of(flag, self.session.document.marks.dismissals) if row >= self._open else None
        if by is None:
            return flag.sentence
        why = plain(by.why, longest=SENTENCE_LENGTH)
        return f"{flag.sentence}\nDismissed: {why}\n{signed(by.author, by.time)}".strip()

    def _here(self) -> list[Flag]:
        """Return what there is at the playhead, what begins there and weighs most first."""
        frame = self.session.view.playhead
        here = [flag for flag in self._flags if flag.start <= frame < flag.stop]
        return sorted(here, key=lambda flag: (flag.start != frame, -flag.weight))

    def _show_here(self) -> None:
        """Show what is wrong at the playhead, the most serious first, and mark its row."""
        here = [self._flags.index(flag) for flag in self._here()]
        here.sort(key=lambda row: row >= self._open)
        self.here.setText("\n".join(self._sentence(row) for row in here[:2]))
        self.here.setVisible(bool(here))
        self._dismiss.setVisible(any(row < self._open for row in here))
        self._restore.setVisible(any(row >= self._open for row in here))
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
