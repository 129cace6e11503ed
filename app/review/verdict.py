"""The verdict on a take: approved, or needs work with a sentence; and all that were given before."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QLineEdit, QPushButton

from app.session import Change, Session
from app.session.commands import MarkCommand
from app.widgets.section import Section, quiet
from app.widgets.times import signed
from engine.project import Verdict, stamp
from engine.words import plain

LONGEST = 400  # characters of a verdict's sentence
APPROVED, NEEDS_WORK = "Approved", "Needs work"
SHOWN = 6  # verdicts of the history
WHY, WHY_NOT = "In a sentence, if you like", "What needs work? Then Enter"


class VerdictSection(Section):
    """Gives verdicts, each one undo step that is kept in the project, and lists those that were given.

    Parameters
    ----------
    session : whose take is judged

    Attributes
    ----------
    author : who judges
    """

    tools = frozenset({"review"})
    wanted = Signal(str)  # the name of an action

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Verdict")
        self.author: Callable[[], str] = str
        self._listed: tuple[Verdict, ...] = ()  # what the history shows
        self._pending = ""  # the verdict whose sentence is typed
        self.approve, self.send_back = QPushButton(APPROVED), QPushButton(f"{NEEDS_WORK}…")
        for button, action in ((self.approve, "approve"), (self.send_back, "send_back")):
            button.setCheckable(True)
            button.clicked.connect(lambda _=False, name=action: self.wanted.emit(name))
        self.approve.setText("Approve")
        self.sentence = QLineEdit()
        self.sentence.setPlaceholderText(WHY)
        self.sentence.setMaxLength(LONGEST)
        self.sentence.setAccessibleName("Why this verdict")
        self.sentence.returnPressed.connect(self._typed)
        self.sentence.installEventFilter(self)
        self.taken_back = QPushButton("Take the verdict back")
        self.taken_back.clicked.connect(lambda: self.judge(""))
        self.history = quiet("")
        self.side_by_side(self.approve, self.send_back)
        self.column.addWidget(self.sentence)
        self.column.addWidget(self.history)
        self.column.addWidget(self.taken_back)
        report = QPushButton("Write a report…")
        report.clicked.connect(lambda: self.wanted.emit("write_report"))
        self.column.addWidget(report)
        session.changed.connect(self._on_change)
        self._show()

    @property
    def current(self) -> Verdict | None:
        """The verdict that counts."""
        verdicts = self.session.document.marks.verdicts
        return verdicts[-1] if verdicts and verdicts[-1].judgement else None

    def ask(self) -> None:
        """Let it be typed what needs work; what was typed already is enough."""
        if self.sentence.isModified() and self.sentence.text().strip():
            self.judge(NEEDS_WORK)
            return
        self._pending = NEEDS_WORK
        self.sentence.setPlaceholderText(WHY_NOT)
        self.sentence.setFocus()
        self.sentence.selectAll()
        self._show_buttons()

    def judge(self, judgement: str) -> None:
        """Give a verdict with the sentence that was typed; nothing takes the one before back."""
        now = self.current
        typed = self.sentence.isModified() or self._pending or (now is not None and now.judgement == judgement)
        why = self.sentence.text().strip() if judgement and typed else ""
        self._pending = ""
        if (now.judgement, now.why) == (judgement, why) if now is not None else not judgement:
            self._show()
            return
        title = f"judge: {judgement.lower()}" if judgement else "take back the verdict"
        verdict = Verdict(judgement, why, self.author(), stamp())
        marks = self.session.document.marks
        self.session.document.undo.push(
            MarkCommand.of(self.session.document, replace(marks, verdicts=(*marks.verdicts, verdict)), title)
        )

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Give up a verdict whose sentence is typed, on Escape."""
        if self._pending and isinstance(event, QKeyEvent) and event.key() == Qt.Key.Key_Escape:
            if event.type() == QEvent.Type.ShortcutOverride:
                event.accept()
                return True
            if event.type() == QEvent.Type.KeyPress:
                self._show()
                self.sentence.clearFocus()
                return True
        return False

    def _typed(self) -> None:
        now = self.current
        judgement = self._pending or (now.judgement if now is not None else "")
        if judgement:
            self.judge(judgement)
            self.sentence.clearFocus()

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE or (change & Change.MARKS and self._listed is not self.session.document.marks.verdicts):
            self._show()

    def _show(self) -> None:
        self._pending = ""
        now, verdicts = self.current, self.session.document.marks.verdicts
        self._listed = verdicts
        self.sentence.setPlaceholderText(WHY)
        self.sentence.setText(plain(now.why) if now is not None else "")
        self.history.setText(
            "\n".join(_line_of(verdict) for verdict in reversed(verdicts[-SHOWN:])) or "No verdict yet."
        )
        self.taken_back.setVisible(now is not None)
        self._show_buttons()

    def _show_buttons(self) -> None:
        now = self.current
        judgement = self._pending or (now.judgement if now is not None else "")
        self.approve.setChecked(judgement == APPROVED)
        self.send_back.setChecked(judgement == NEEDS_WORK)


def _line_of(verdict: Verdict) -> str:
    """Return a verdict with who gave it and when."""
    text = plain(verdict.sentence) if verdict.judgement else " ".join(["Taken back.", plain(verdict.why)]).strip()
    by = signed(verdict.author, verdict.time)
    return f"{text}\n{by}" if by else text
