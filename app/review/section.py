"""What was changed, one line each, and the verdict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QComboBox, QLineEdit, QListWidget, QListWidgetItem, QPushButton

from app.session import Change, Session
from app.session.commands import MarkCommand
from app.theme import GRID
from app.widgets.section import Section, quiet
from engine.project import Verdict
from engine.review.changes import Change as Difference
from engine.review.report import REGION_TITLES, clock
from engine.words import SENTENCE_LENGTH, counted, plain

LIST_PX = 220
LONGEST = 400  # characters of a verdict's sentence
VERDICTS = ("No verdict yet", "Approved", "Needs work")
FRAMES = Qt.ItemDataRole.UserRole


class ReviewSection(Section):
    """Lists the changes, goes to the one that is clicked, and keeps the verdict in the project.

    Parameters
    ----------
    session : whose take is reviewed
    """

    tools = frozenset({"review"})
    wanted = Signal(str)  # the name of an action

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Changes")
        self._changes: tuple[Difference, ...] = ()
        self.author: Callable[[], str] = str  # who judges
        self.summary = quiet("Comparing…")
        self.column.addWidget(self.summary)
        self.list = QListWidget()
        self.list.setFixedHeight(LIST_PX)
        self.list.setAccessibleName("Changes")
        self.list.setWordWrap(True)
        self.list.setSpacing(GRID // 4)
        self.list.itemActivated.connect(self._go_to)
        self.list.itemClicked.connect(self._go_to)
        self.column.addWidget(self.list)
        self.side_by_side(self._button("Previous", "previous_change"), self._button("Next", "next_change"))
        self.verdict = QComboBox()
        self.verdict.addItems(VERDICTS)
        self.row("Verdict", self.verdict)
        self.sentence = QLineEdit()
        self.sentence.setPlaceholderText("Why, then Enter")
        self.sentence.setMaxLength(LONGEST)
        self.sentence.setAccessibleName("Why this verdict")
        self.column.addWidget(self.sentence)
        self.verdict.activated.connect(self._judge)
        self.sentence.returnPressed.connect(self._judge)
        self.column.addWidget(self._button("Write a report…", "write_report"))
        self.column.addWidget(self._button("Compare with another take…", "compare_take"))
        session.changed.connect(self._on_change)
        self._show_verdict()

    def _button(self, title: str, action: str) -> QPushButton:
        button = QPushButton(title)
        button.clicked.connect(lambda: self.wanted.emit(action))
        return button

    @property
    def changes(self) -> tuple[Difference, ...]:
        """What was changed, in order of time."""
        return self._changes

    def show_changes(self, changes: tuple[Difference, ...]) -> None:
        """List these changes; the chosen line stays where it still is."""
        fps = self.session.document.take.fps
        self._changes = changes
        row = self.list.currentRow()
        self.list.clear()
        for change in changes:
            amount = f"{change.control} {change.by_mm:+.1f} mm" if abs(change.by_mm) >= 0.05 else "slightly"
            by = f"\n{plain('; '.join(change.edits), longest=SENTENCE_LENGTH)}" if change.edits else ""
            item = QListWidgetItem(
                f"{clock(change.start, fps)}  {REGION_TITLES[change.region]}, {amount}, "
                f"{(change.stop - change.start) / fps:.2f} s{by}"
            )
            item.setData(FRAMES, (change.start, change.stop, change.peak))
            self.list.addItem(item)
        if 0 <= row < len(changes):
            self.list.setCurrentRow(row)
        differ = sum(change.stop - change.start for change in changes)
        self.summary.setText(
            f"{counted(len(changes), 'change')} over {differ:,} of {counted(len(self.session.document.take), 'frame')}."
            if changes
            else "Nothing differs from the recording. Edit the take, or compare it with another one."
        )

    def step(self, by: int) -> None:
        """Go to the next change after the playhead, or to the one before it."""
        here = self.session.view.playhead
        peaks = [change.peak for change in self._changes]
        later = [index for index, peak in enumerate(peaks) if peak > here]
        earlier = [index for index, peak in enumerate(peaks) if peak < here]
        if by > 0 and later:
            self._choose(later[0])
        elif by < 0 and earlier:
            self._choose(earlier[-1])

    def judge(self, index: int) -> None:
        """Give one of the verdicts, with the sentence that is typed; one undo step."""
        self.verdict.setCurrentIndex(index)
        self._judge()

    def _choose(self, index: int) -> None:
        self.list.setCurrentRow(index)
        self._go_to(self.list.item(index))

    def _go_to(self, item: QListWidgetItem) -> None:
        start, stop, peak = item.data(FRAMES)
        self.session.view.select((start, stop))
        self.session.view.move_playhead(peak)

    def _judge(self, *_: object) -> None:
        chosen = self.verdict.currentIndex()
        why = self.sentence.text().strip()
        now = datetime.now(UTC).isoformat(timespec="seconds")
        verdict = Verdict(VERDICTS[chosen], why, self.author(), now) if chosen else Verdict("", "", self.author(), now)
        marks = self.session.document.marks
        if verdict.sentence != marks.verdict:
            title = "take back the verdict" if chosen == 0 else f"judge: {VERDICTS[chosen].lower()}"
            verdicts = (*marks.verdicts, verdict)
            self.session.document.undo.push(
                MarkCommand.of(self.session.document, replace(marks, verdicts=verdicts), title)
            )

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self.show_changes(())
            self.summary.setText("Comparing…")
        if change & (Change.TAKE | Change.MARKS):
            self._show_verdict()

    def _show_verdict(self) -> None:
        verdict = self.session.document.marks.verdict
        title, _, why = verdict.partition(": ")
        self.verdict.setCurrentIndex(VERDICTS.index(title) if title in VERDICTS else 0)
        self.sentence.setText(why)
