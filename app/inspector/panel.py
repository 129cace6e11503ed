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

from app.curve_table import CURVES
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
    value_typed = Signal(float)  # for the curve that is worked on, at the playhead
    cutoff_moved = Signal(float)  # Hz, while it moves
    smooth = Signal()
    dropped = Signal()  # the preview of a filter is not wanted

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
        self._filter(column)
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
        shown = self._session.value(self._session.lane, self._session.playhead)
        if abs(self.value.value() - round(shown, self.value.decimals())) > 0.4 * 10.0 ** -self.value.decimals():
            self.value_typed.emit(self.value.value())

    def _filter(self, column: QVBoxLayout) -> None:
        column.addSpacing(GRID)
        column.addWidget(_heading("Smooth"))
        self.cutoff = QDoubleSpinBox()
        self.cutoff.setDecimals(1)
        self.cutoff.setSuffix(" Hz")
        self.cutoff.setToolTip("Butterworth, zero phase: peaks stay where they are. The selection, or the whole take.")
        self._cutoff_slider = _slider(5, 140)
        _row(column, "Cutoff", self.cutoff)
        column.addWidget(self._cutoff_slider)
        row = QHBoxLayout()
        self.smooth_button, self.drop_button = QPushButton("Apply"), QPushButton("Drop")
        row.addWidget(self.smooth_button)
        row.addWidget(self.drop_button)
        column.addLayout(row)
        self._cutoff_slider.valueChanged.connect(self._slide_cutoff)
        self.cutoff.valueChanged.connect(self.cutoff_moved)
        self.smooth_button.clicked.connect(self.smooth)
        self.drop_button.clicked.connect(self.dropped)

    def _slide_cutoff(self, value: int) -> None:
        self.cutoff.setValue(value / 10)

    def _show_cutoff(self) -> None:
        highest = 0.45 * self._session.take.fps
        with QSignalBlocker(self.cutoff), QSignalBlocker(self._cutoff_slider):
            self.cutoff.setRange(0.5, highest)
            self._cutoff_slider.setRange(5, int(10 * highest))
            self.cutoff.setValue(min(6.0, highest))
            self._cutoff_slider.setValue(int(10 * self.cutoff.value()))

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
            self._show_cutoff()
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
        session, curve = self._session, CURVES[self._session.lane]
        self._lane_title.setText(curve.title[0].upper() + curve.title[1:])
        self.close_button.setVisible(closes(session.lane))
        self.value.setDecimals(2 if curve.is_weight else 1)
        self.value.setSingleStep(0.05 if curve.is_weight else 0.5)
        self.value.setSuffix("" if curve.is_weight else f" {curve.unit}")
        if not self.value.hasFocus():
            with QSignalBlocker(self.value):
                self.value.setValue(session.value(session.lane, session.playhead))

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


def closes(lane: int) -> bool:
    """Return whether a curve is a distance that can be closed: the lips', or an eye's."""
    curve = CURVES[lane]
    control = CONTROLS[curve.column] if not curve.is_weight else None
    return control is not None and (control.name == "lips_vertical" or control.area == "eyelids")


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
