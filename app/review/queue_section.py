"""The queue of pairs: how many are judged, which is open, and what was verdict of each."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtGui import QBrush, QColor
from PySide6.QtWidgets import QListWidget, QListWidgetItem, QProgressBar, QPushButton

from app.review.queueing import Queueing
from app.review.verdict import APPROVED
from app.session import Session
from app.widgets.section import Section
from app.widgets.text import tip
from engine.review.queue import Entry, progress
from engine.words import NAME_LENGTH, plain

ROW_PX, ROWS = 18, 6
GOOD, BAD, OPEN, TROUBLE = "✓", "!", "○", "✕"  # a sign for each state, so that colour is never alone


class QueueSection(Section):
    """Lists the pairs of a folder with their verdicts; one that is clicked is opened.

    Parameters
    ----------
    session : what is open
    queueing : the queue
    """

    tools = frozenset({"review"})
    wanted = Signal(str)  # the name of an action

    def __init__(self, session: Session, queueing: Queueing) -> None:
        super().__init__(session, "Queue")
        self._queueing = queueing
        self.list, self.bar = QListWidget(), QProgressBar()
        self.list.setAccessibleName("Pairs of the queue")
        self.list.setUniformItemSizes(True)
        self.list.itemActivated.connect(self._go_to)
        self.list.itemClicked.connect(self._go_to)
        self.bar.setTextVisible(True)
        self.bar.setAccessibleName("Pairs that are judged")
        self._previous, self._next = (
            self._button("Previous take", "previous_take"),
            self._button("Next take", "next_take"),
        )
        self.column.addWidget(self.bar)
        self.column.addWidget(self.list)
        self.side_by_side(self._previous, self._next)
        self.column.addWidget(self._button("Open a folder of pairs…", "open_queue"))
        queueing.changed.connect(self._show)
        self._show()

    def _button(self, title: str, action: str) -> QPushButton:
        button = QPushButton(title)
        button.clicked.connect(lambda: self.wanted.emit(action))
        return button

    def _go_to(self, item: QListWidgetItem) -> None:
        self._queueing.go_to(self.list.row(item))

    def _show(self) -> None:
        queue, current = self._queueing.queue, self._queueing.current
        with QSignalBlocker(self.list):
            self.list.clear()
            for entry in queue:
                item = QListWidgetItem(f"{_sign(entry)}  {plain(entry.after.name, longest=NAME_LENGTH)}", self.list)
                item.setToolTip(tip(_description(entry)))
                if entry.trouble:
                    item.setForeground(QBrush(QColor("#E69F00")))
            self.list.setCurrentRow(-1 if current is None else current)
        hint = self.list.sizeHintForRow(0) if queue else 0
        row = hint if hint > 0 else ROW_PX
        self.list.setFixedHeight(row * min(ROWS, max(1, len(queue))) + 10)
        self.bar.setRange(0, max(1, len(queue)))
        self.bar.setValue(sum(entry.judged for entry in queue))
        self.bar.setFormat(progress(queue))
        for widget in (self.list, self.bar, self._previous, self._next):
            widget.setVisible(bool(queue))
        self._previous.setEnabled(current is None or current > 0)
        self._next.setEnabled(current is None or current + 1 < len(queue))


def _sign(entry: Entry) -> str:
    if entry.trouble:
        return TROUBLE
    if entry.verdict is None or not entry.judged:
        return OPEN
    return GOOD if entry.verdict.judgement == APPROVED else BAD


def _description(entry: Entry) -> str:
    """Return all that is known of a pair."""
    verdict = entry.trouble or (
        entry.verdict.sentence if entry.verdict is not None and entry.judged else "Not judged yet."
    )
    return f"{entry.before.name} and {entry.after.name}\n{verdict}"
