"""The panel at the right: the tool's settings, the spans, and what the edit came to."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QDoubleSpinBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLayout,
    QPushButton,
    QSlider,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from app.session import Change, Session
from app.theme import GRID
from engine.controls import CONTROLS
from engine.take import runs, timecode

WIDTH_PX = 232
SHOWN_SPANS = 6


class Inspector(QFrame):
    """What can be set for the gesture at hand, by slider and by typing.

    Parameters
    ----------
    session : whose tool, spans and edits are shown
    """

    close_here = Signal()
    value_typed = Signal(float)  # mm, for the lane that is worked on at the playhead

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.setProperty("panel", True)
        self.setFixedWidth(WIDTH_PX)
        self._session = session
        column = QVBoxLayout(self)
        column.setContentsMargins(2 * GRID, 2 * GRID - 4, 2 * GRID, 2 * GRID)
        column.setSpacing(GRID)
        self._brush(column)
        self._value(column)
        self._spans(column)
        self._edit(column)
        column.addStretch(1)
        session.changed.connect(self._on_change)
        self._on_change(Change.TAKE)

    def _brush(self, column: QVBoxLayout) -> None:
        column.addWidget(_heading("Drag"))
        self.radius = QSpinBox(minimum=1, maximum=300, suffix=" frames")
        self._radius_slider = _slider(1, 120)
        self.radius.setToolTip("How many frames on either side follow. Turn the wheel while dragging to change it.")
        _row(column, "Radius", self.radius)
        column.addWidget(self._radius_slider)
        self.strength = QSpinBox(minimum=0, maximum=100, suffix=" %")
        self._strength_slider = _slider(0, 100)
        _row(column, "Strength", self.strength)
        column.addWidget(self._strength_slider)
        self.exact = QCheckBox("Hit the curve exactly")
        self.exact.setToolTip("Plausible, the default, keeps the face believable; exact goes where you drag it.")
        column.addWidget(self.exact)
        for widget in (self.radius, self._radius_slider):
            widget.valueChanged.connect(lambda value: self._session.set_brush(radius_frames=value))
        for widget in (self.strength, self._strength_slider):
            widget.valueChanged.connect(lambda value: self._session.set_brush(strength=value / 100))
        self.exact.toggled.connect(lambda on: self._session.set_brush(exact=on))

    def _value(self, column: QVBoxLayout) -> None:
        self._lane_title = _heading("")
        column.addSpacing(GRID)
        column.addWidget(self._lane_title)
        self.value = QDoubleSpinBox(decimals=1, minimum=0.0, maximum=200.0, singleStep=0.5, suffix=" mm")
        self.value.setKeyboardTracking(False)
        self.value.setToolTip("Type what it should be at the playhead; the brush's radius eases it in and out.")
        _row(column, "At the playhead", self.value)
        self.value.editingFinished.connect(self._typed)
        self.close_button = QPushButton("Close here")
        self.close_button.setToolTip(
            "Bring the lips, or the eyelids, together on the selection or around the playhead."
        )
        self.close_button.clicked.connect(self.close_here)
        column.addWidget(self.close_button)

    def _typed(self) -> None:
        shown = float(self._session.shown_controls(self._session.playhead)[self._session.lane])
        if abs(self.value.value() - round(shown, 1)) > 0.04:
            self.value_typed.emit(self.value.value())

    def _spans(self, column: QVBoxLayout) -> None:
        column.addSpacing(GRID)
        column.addWidget(_heading("Spans"))
        self._span_box = QVBoxLayout()
        self._span_box.setSpacing(4)
        column.addLayout(self._span_box)

    def _edit(self, column: QVBoxLayout) -> None:
        column.addSpacing(GRID)
        column.addWidget(_heading("This edit"))
        self._facts = QLabel()
        self._facts.setProperty("quiet", True)
        self._facts.setWordWrap(True)
        column.addWidget(self._facts)

    # --- showing

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.TOOL):
            self._show_brush()
        if change & Change.TAKE:
            self._show_spans()
        if change & (Change.TAKE | Change.LANE | Change.PLAYHEAD | Change.CURVES | Change.DRAFT):
            self._show_value()
        if change & (Change.TAKE | Change.CURVES | Change.DRAFT):
            self._facts.setText(self._describe())

    def _show_brush(self) -> None:
        session = self._session
        percent = round(100 * session.strength)
        for widget, value in (
            (self.radius, session.radius_frames),
            (self._radius_slider, session.radius_frames),
            (self.strength, percent),
            (self._strength_slider, percent),
        ):
            with QSignalBlocker(widget):
                widget.setValue(value)
        with QSignalBlocker(self.exact):
            self.exact.setChecked(session.exact)

    def _show_value(self) -> None:
        session, control = self._session, CONTROLS[self._session.lane]
        self._lane_title.setText(control.title[0].upper() + control.title[1:])
        self.close_button.setVisible(control.name == "lips_vertical" or control.area == "eyelids")
        if not self.value.hasFocus():
            with QSignalBlocker(self.value):
                self.value.setValue(float(session.shown_controls(session.playhead)[session.lane]))

    def _show_spans(self) -> None:
        while (item := self._span_box.takeAt(0)) is not None:
            if (old := item.widget()) is not None:
                old.deleteLater()
        spans, fps = runs(self._session.take.lost), self._session.take.fps
        for start, stop in spans[:SHOWN_SPANS]:
            button = QPushButton(f"{timecode(start / fps, fps)}  lost · {stop - start} frames")
            button.setToolTip("Go to this span and select it")
            button.clicked.connect(lambda _=False, a=start, b=stop: self._go_to(a, b))
            self._span_box.addWidget(button)
        if len(spans) > SHOWN_SPANS:
            self._span_box.addWidget(_quiet(f"and {len(spans) - SHOWN_SPANS} more"))
        if not spans:
            self._span_box.addWidget(_quiet("The tracker lost nothing."))

    def _go_to(self, start: int, stop: int) -> None:
        self._session.select((start, stop))
        self._session.move_playhead(start)

    def _describe(self) -> str:
        session, draft = self._session, self._session.draft
        changed = session.undo.count() and session.undo.index()
        if draft is None and not changed:
            return "Nothing changed yet. Drag a curve up or down."
        now, before = session.take.weights, session.original.weights
        moved = int((now != before).any(axis=1).sum()) if len(now) < 20000 or draft is None else 0
        lines = []
        if draft is not None:
            moved_lanes = np.flatnonzero((draft.asked != session.controls[draft.start : draft.stop]).any(axis=0))
            for lane in moved_lanes:
                away = np.abs(draft.asked[:, lane] - session.controls[draft.start : draft.stop, lane])
                row = int(np.argmax(away))
                asked, reached = draft.asked[row, lane], draft.reached[row, lane]
                lines.append(f"{CONTROLS[lane].title}: asked {asked:.1f}, reached {reached:.1f} mm")
            lines.append(f"moves {draft.stop - draft.start:,} of {len(now):,} frames")
        else:
            lines.append(f"{moved:,} of {len(now):,} frames differ from the original")
            lines.append(f"{len(now) - moved:,} frames bit-identical")
        return "\n".join(lines)


def _slider(lowest: int, highest: int) -> QSlider:
    slider = QSlider(Qt.Orientation.Horizontal)
    slider.setRange(lowest, highest)
    return slider


def _heading(text: str) -> QLabel:
    label = QLabel(text)
    label.setProperty("heading", True)
    return label


def _quiet(text: str) -> QLabel:
    label = QLabel(text)
    label.setProperty("quiet", True)
    return label


def _row(column: QVBoxLayout, title: str, widget: QWidget) -> QLayout:
    row = QHBoxLayout()
    label = _quiet(title)
    label.setBuddy(widget)
    row.addWidget(label, 1)
    row.addWidget(widget)
    column.addLayout(row)
    widget.setAccessibleName(title)
    return row
