"""What was changed, one line each, and where the take before lies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QListWidget, QListWidgetItem, QPushButton, QWidget

from app.session import Change, Session
from app.theme import GRID
from app.widgets.section import NUMBER_PX, Section, quiet
from engine.review.changes import Change as Difference
from engine.review.pairing import alignment_of
from engine.review.report import REGION_TITLES, clock
from engine.words import SENTENCE_LENGTH, counted, plain

LIST_PX = 150
FRAMES = Qt.ItemDataRole.UserRole
FARTHEST_FRAMES = 1_000_000.0


class ReviewSection(Section):
    """Lists the changes, goes to the one that is clicked, and lets the take before be moved in time.

    Parameters
    ----------
    session : whose take is reviewed
    """

    tools = frozenset({"review"})
    wanted = Signal(str)  # the name of an action
    moved = Signal(float)  # seconds at which the take before shall lie

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Changes")
        self._changes: tuple[Difference, ...] = ()
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
        self.side_by_side(
            self._button("Previous", "previous_change"),
            self._button("Loop", "loop_change"),
            self._button("Next", "next_change"),
        )
        self._lay_out_offset()
        self.column.addWidget(self._button("Compare with another take…", "compare_take"))
        session.changed.connect(self._on_change)

    def _lay_out_offset(self) -> None:
        self.alignment, self.offset = quiet(""), QDoubleSpinBox()
        self.offset.setRange(-FARTHEST_FRAMES, FARTHEST_FRAMES)
        self.offset.setDecimals(2)
        self.offset.setSuffix(" frames")
        self.offset.setKeyboardTracking(False)
        self.offset.setToolTip("How much later the take before is than the one after, in frames of the one after")
        self.offset.valueChanged.connect(lambda frames: self.moved.emit(frames / self.session.document.take.fps))
        self.column.addWidget(self.alignment)
        self._offset_row = QWidget()
        row = QHBoxLayout(self._offset_row)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(quiet("Offset"), 1)
        row.addWidget(self.offset)
        self.offset.setAccessibleName("Offset")
        self.offset.setFixedWidth(NUMBER_PX + 24)
        self.column.addWidget(self._offset_row)
        self.show_pair(None)

    def _button(self, title: str, action: str) -> QPushButton:
        button = QPushButton(title)
        button.clicked.connect(lambda: self.wanted.emit(action))
        return button

    @property
    def changes(self) -> tuple[Difference, ...]:
        """What was changed, in order of time."""
        return self._changes

    @property
    def here(self) -> Difference | None:
        """The change at the playhead, or else the first after it, or the last of all."""
        frame = self.session.view.playhead
        later = [change for change in self._changes if change.stop > frame]
        return later[0] if later else self._changes[-1] if self._changes else None

    def show_pair(self, inputs: Mapping[str, Any] | None) -> None:
        """Show how two takes were brought together; None where there is no second one."""
        for widget in (self.alignment, self._offset_row):
            widget.setVisible(inputs is not None)
        if inputs is None:
            return
        alignment = alignment_of(inputs)
        alike = f" Both move alike by {alignment.correlation:.2f}." if inputs.get("by") != "offset" else ""
        name = plain(str(inputs.get("name", "")), longest=SENTENCE_LENGTH)
        self.alignment.setText(f"Before: {name}, {alignment.sentence}.{alike}")
        with QSignalBlocker(self.offset):
            self.offset.setValue(alignment.offset_s * self.session.document.take.fps)

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

    def _choose(self, index: int) -> None:
        self.list.setCurrentRow(index)
        self._go_to(self.list.item(index))

    def _go_to(self, item: QListWidgetItem) -> None:
        start, stop, peak = item.data(FRAMES)
        self.session.view.select((start, stop))
        self.session.view.move_playhead(peak)

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self.show_changes(())
            self.summary.setText("Comparing…")
