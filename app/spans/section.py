"""The spans of the take, and how the chosen one is filled."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

from PySide6.QtCore import QPoint, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QFileDialog,
    QHBoxLayout,
    QPushButton,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from app.session import Change, Session
from app.session.commands import MarkCommand
from app.spans.filling import Filling
from app.spans.strip import Strip
from app.widgets.section import CountBox, Section, empty, quiet
from app.widgets.text import caption
from engine.editing import FillRequest, Style
from engine.errors import EngineError
from engine.formats import read_take
from engine.project import Span
from engine.take import Take, timecode
from engine.words import counted

SHOWN_SPANS = 8
REGIONS = {
    "whole face": "face",
    "lower face": "lower",
    "upper face": "upper",
    "eyes": "eyes",
    "left side": "left",
    "right side": "right",
}
STYLES: dict[str, Style] = {"as fits the length": "auto", "a performance": "perform", "a smooth bridge": "bridge"}


class SpansSection(Section):
    """Lists spans; the chosen one can be given a region, filled, or removed.

    Parameters
    ----------
    session : whose spans are shown
    filling : makes the variants
    """

    away = frozenset({"review"})
    refused = Signal(str, str)
    menu_wanted = Signal(QPoint)  # on the screen, after the span was chosen

    def __init__(self, session: Session, filling: Filling) -> None:
        super().__init__(session, "Spans")
        self._filling = filling
        self._guide: Take | None = None
        self._list = QVBoxLayout()
        self._list.setSpacing(4)
        self.column.addLayout(self._list)
        self._chosen_box = QWidget()
        self._lay_out_chosen()
        self.column.addWidget(self._chosen_box)
        self.strip = Strip()
        self.strip.chosen.connect(filling.choose)
        self.column.addWidget(self.strip)
        self.seed = quiet("")
        self.seed.setToolTip("What this variant was drawn from; the same steering and seed give the same motion.")
        self.column.addWidget(self.seed)
        self.accept_button, self.again_button, self.drop_button = (
            QPushButton("Keep"),
            QPushButton("Others"),
            QPushButton("Discard"),
        )
        self.accept_button.setProperty("primary", True)
        self.accept_button.setToolTip("Keep this variant (Enter)")
        self.again_button.setToolTip("Make six others")
        self.accept_button.clicked.connect(filling.accept)
        self.again_button.clicked.connect(filling.again)
        self.drop_button.clicked.connect(filling.drop)
        self.side_by_side(self.accept_button, self.again_button, self.drop_button)
        filling.changed.connect(self._show)
        session.changed.connect(self._on_change)
        self._show_list()
        self._show()

    def _lay_out_chosen(self) -> None:
        box = QVBoxLayout(self._chosen_box)
        box.setContentsMargins(0, 0, 0, 0)
        self.region = QComboBox()
        self.region.addItems(list(REGIONS))
        self.region.setAccessibleName("Region")
        self.region.setToolTip("Which part of the face is filled; the rest stays as it is.")
        self.style_box = QComboBox()
        self.style_box.addItems(list(STYLES))
        self.style_box.setAccessibleName("Fill with")
        self.curves = QCheckBox("Follow my curves")
        self.curves.setToolTip("Let the fill follow what you dragged or drew inside the span.")
        self.visemes = QCheckBox("Say the visemes")
        self.visemes.setToolTip("Let the mouth say what the visemes lane does over the span.")
        self.visemes.setChecked(True)
        self.guide_button = QPushButton("Guide by a take…")
        self.guide_button.setToolTip("Another take of the same rate, such as a rough one from a webcam.")
        self.unguide_button = QPushButton("Without the guide")
        self.unguide_button.setToolTip("Fill without following the other take.")
        self.guide_shift = CountBox("frame", lowest=-999_999, highest=999_999)
        self.guide_shift.setToolTip("How many frames later in the guide the same moment lies.")
        self._shift_row = _named("Guide is ahead by", self.guide_shift)
        self.fill_button, self.remove_button = QPushButton("Fill"), QPushButton("Unmark")
        self.fill_button.setProperty("primary", True)
        self.fill_button.setToolTip("Fill the chosen span (F)")
        self.note = quiet("")
        buttons = QHBoxLayout()
        buttons.addWidget(self.fill_button, 1)
        buttons.addWidget(self.remove_button, 1)
        box.addLayout(buttons)  # above the settings: beneath them a low screen has no room
        for widget in (
            self.region,
            self.style_box,
            self.curves,
            self.visemes,
            self.guide_button,
            self.unguide_button,
            self._shift_row,
            self.note,
        ):
            box.addWidget(widget)
        self._shift_row.hide()
        self.unguide_button.hide()
        self.region.activated.connect(self._set_region)
        self.guide_button.clicked.connect(self._choose_guide)
        self.unguide_button.clicked.connect(lambda: self.guide_by(None))
        self.fill_button.clicked.connect(self.fill)
        self.remove_button.clicked.connect(self.unmark)

    @property
    def chosen(self) -> Span | None:
        """The span that is selected, if any."""
        for span in self.session.document.marks.spans:
            if (span.start, span.stop) == self.session.view.selection:
                return span
        return None

    def mark(self) -> None:
        """Make the selection a span."""
        selection, marks = self.session.view.selection, self.session.document.marks
        if selection is None or self.chosen is not None:
            return
        for other in marks.spans:  # one that was lost may lie within: it is often filled with some frames around it
            if other.kind != "lost" and other.start < selection[1] and selection[0] < other.stop:
                where = f"Frames {other.start} to {other.stop - 1}"
                self.refused.emit(f"{where} are marked already.", "Unmark them, or mark frames beside them.")
                return
        spans = sorted((*marks.spans, Span(*selection)), key=lambda span: span.start)
        self.session.document.undo.push(
            MarkCommand.of(self.session.document, replace(marks, spans=tuple(spans)), "mark a span")
        )

    def unmark(self) -> None:
        """Remove the chosen span; its frames stay as they are."""
        chosen, marks = self.chosen, self.session.document.marks
        if chosen is not None:
            rest = tuple(span for span in marks.spans if span != chosen)
            self.session.document.undo.push(
                MarkCommand.of(self.session.document, replace(marks, spans=rest), "unmark a span")
            )

    def fill(self) -> None:
        """Fill the chosen span, or the selection."""
        span = self.chosen or (Span(*self.session.view.selection) if self.session.view.selection else None)
        spans = self.session.document.marks.spans
        if span is None and len(spans) == 1:  # there is only one that can be meant
            self._go_to(span := spans[0])
        if span is None:
            self.refused.emit("No span is chosen.", "Click one in the spans lane, or drag there to mark one.")
            return
        how = FillRequest(
            (span.start, span.stop),
            style=STYLES[self.style_box.currentText()],
            guide=self._guide,
            guide_offset=self.guide_shift.value(),
        )
        self._filling.start(
            span,
            how,
            keep_curves=self.curves.isChecked(),
            keep_visemes=self.visemes.isChecked(),
        )

    def _set_region(self, _: int) -> None:
        chosen, marks = self.chosen, self.session.document.marks
        if chosen is not None:
            changed = replace(chosen, region=REGIONS[self.region.currentText()])
            spans = tuple(changed if span == chosen else span for span in marks.spans)
            self.session.document.undo.push(
                MarkCommand.of(self.session.document, replace(marks, spans=spans), "choose a region")
            )

    def _choose_guide(self) -> None:
        name, _ = QFileDialog.getOpenFileName(self, "A take to follow", "", "Takes (*.csv)")
        if name:
            self.guide_by(Path(name))

    def guide_by(self, path: Path | None) -> None:
        """Let fills follow a take, or none; where it cannot be read, the guide stays as it was."""
        try:
            self._guide = read_take(path) if path else None
        except EngineError as error:
            self.refused.emit(error.sentence, error.advice)
        self.guide_button.setText(caption(f"Guide: {self._guide.name}") if self._guide else "Guide by a take…")
        for widget in (self._shift_row, self.unguide_button):
            widget.setVisible(self._guide is not None)

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self.guide_by(None)  # it was for the take before
            self.guide_shift.setValue(0)
        if change & (Change.TAKE | Change.MARKS | Change.SELECTION | Change.VISEMES | Change.CURVES):
            self._show_list()
            self._show()

    def _show_list(self) -> None:
        empty(self._list)
        spans, fps, chosen = self.session.document.marks.spans, self.session.document.take.fps, self.chosen
        to_do = set(self.session.document.open_spans)
        for span in spans[:SHOWN_SPANS]:
            kind = "marked" if span.kind != "lost" else "lost" if span in to_do else "filled"
            length = counted(span.stop - span.start, "frame")
            button = QPushButton(f"{timecode(span.start / fps, fps)}  {kind} · {length}")
            button.setCheckable(True)
            button.setChecked(span == chosen)
            button.setToolTip("Go to this span and choose it")
            button.clicked.connect(lambda _=False, span=span: self._go_to(span))
            button.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
            button.customContextMenuRequested.connect(partial(self._open_menu, span, button))
            self._list.addWidget(button)
        if len(spans) > SHOWN_SPANS:
            self._list.addWidget(quiet(f"and {len(spans) - SHOWN_SPANS:,} more"))
        if not spans:
            self._list.addWidget(quiet("None. Drag in the spans lane to mark one."))

    def _open_menu(self, span: Span, button: QPushButton, at: QPoint) -> None:
        where = button.mapToGlobal(at)
        self._go_to(span)  # which lists the spans anew
        self.menu_wanted.emit(where)

    def _go_to(self, span: Span) -> None:
        self.session.view.select((span.start, span.stop))
        self.session.view.move_playhead(span.start)

    def _show(self) -> None:
        chosen, filling = self.chosen, self._filling
        self._chosen_box.setVisible(chosen is not None and not filling.variants)
        any_variants = bool(filling.variants)
        for widget in (self.strip, self.seed, self.accept_button, self.again_button, self.drop_button):
            widget.setVisible(any_variants)
        self.seed.setText(filling.title)
        self.again_button.setEnabled(len(filling.variants) > 1)
        self.strip.show_variants(filling.variants, filling.chosen, first=filling.first)
        self.fill_button.setText("Filling…" if filling.busy else "Fill")
        self.fill_button.setEnabled(not filling.busy)
        if chosen is not None:
            self.visemes.setVisible(bool(filling.said(chosen)))
            names = {region: title for title, region in REGIONS.items()}
            with QSignalBlocker(self.region):
                self.region.setCurrentText(names.get(chosen.region, next(iter(REGIONS))))
            pins = sum(chosen.start <= pin.frame < chosen.stop for pin in self.session.document.marks.pins)
            self.note.setText(f"{counted(pins, 'pin')} inside will be met exactly." if pins else "")
            self.note.setVisible(bool(pins))


def _named(title: str, box: QSpinBox) -> QWidget:
    """Return a number with its name before."""
    row_widget = QWidget()
    row = QHBoxLayout(row_widget)
    row.setContentsMargins(0, 0, 0, 0)
    row.addWidget(quiet(title), 1)
    row.addWidget(box)
    box.setAccessibleName(title)
    return row_widget
