"""How the target head was read: what its shapes were taken for, its unit and its axes, each to be corrected."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QCheckBox, QComboBox, QGridLayout, QHeaderView, QTableWidget, QTableWidgetItem, QWidget

from app.retarget.retargeting import Retargeting
from app.session import Session
from app.widgets.section import Section, quiet
from engine.formats.characters.frame import UNITS_MM, UPS
from engine.formats.characters.names import Match, reviewed
from engine.take import SHAPES
from engine.words import counted

LEFT_OUT = "left out"
FOUND = "as found"
FACINGS = tuple(str(turn) for turn in (0, 45, 90, 135, 180, -135, -90, -45))
TABLE_PX, ROW_PX = 210, 24


class HeadSection(Section):
    """Lists the shapes that want a look, and how the file's coordinates were read; each choice reads the head anew.

    Parameters
    ----------
    session : whose tool is at work
    retargeting : whose target it is

    Attributes
    ----------
    table : the file's names, and a box with what each is taken for
    boxes : the boxes, by the file's name
    all_shapes : whether those without doubt are listed too
    unit, up, facing : of the file
    """

    tools = frozenset({"retarget"})

    def __init__(self, session: Session, retargeting: Retargeting) -> None:
        super().__init__(session, "Head as read")
        self._retargeting = retargeting
        self._facts = quiet("")
        self.column.addWidget(self._facts)
        self.unit, self.up = _box("Unit", (FOUND, *UNITS_MM)), _box("Upward axis", (FOUND, *UPS))
        self.facing = _box("Turned to its left by", (FOUND, *FACINGS))
        self._frame = QWidget()
        grid = QGridLayout(self._frame)
        grid.setContentsMargins(0, 0, 0, 0)
        for row, (title, box) in enumerate((("Unit", self.unit), ("Up", self.up), ("Turned, degrees", self.facing))):
            grid.addWidget(quiet(title), row, 0)
            grid.addWidget(box, row, 1)
        self.column.addWidget(self._frame)
        self.unit.activated.connect(lambda _: retargeting.choosing.read_anew(unit=_chosen(self.unit)))
        self.up.activated.connect(lambda _: retargeting.choosing.read_anew(up=_chosen(self.up)))
        self.facing.activated.connect(lambda _: retargeting.choosing.read_anew(facing_deg=_degrees(self.facing)))
        self.table = QTableWidget(0, 2)
        self.table.setHorizontalHeaderLabels(["In the file", "Taken for"])
        self.table.setAccessibleName("Shapes of the head")
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(ROW_PX)
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self.table.setEditTriggers(QTableWidget.EditTrigger.NoEditTriggers)
        self.column.addWidget(self.table)
        self.all_shapes = QCheckBox("List all shapes")
        self.all_shapes.setToolTip(
            "Without it only those are listed that were matched by likeness, left out or there twice"
        )
        self.all_shapes.toggled.connect(lambda _: self.show_all())
        self.column.addWidget(self.all_shapes)
        self.boxes: dict[str, QComboBox] = {}
        self._listed: tuple[Match, ...] = ()
        retargeting.changed.connect(self.show_all)
        self.show_all()

    def show_all(self) -> None:
        """Show how the target was read."""
        state = self._retargeting
        made, refused = state.target.imported, state.choosing.refused
        reading = refused[1] if refused else state.target.reading
        self.needed = made is not None or refused is not None
        self.setVisible(self.needed and self.session.view.tool in self.tools)
        for part in (self._frame, self.table, self.all_shapes):
            part.setVisible(made is not None or (refused is not None and part is self._frame))
        for box, value in ((self.unit, reading.unit), (self.up, reading.up), (self.facing, _turn(reading.facing_deg))):
            with QSignalBlocker(box):
                if value and box.findText(value) < 0:
                    box.addItem(value)
                box.setCurrentText(value or FOUND)
        if refused is not None:
            self._facts.setText(
                f"{refused[0].name} could not be used. If its unit or its axes were misread, choose them here."
            )
            self.table.hide()
            self.all_shapes.hide()
            return
        if made is None:
            return
        rows = made.matches if self.all_shapes.isChecked() else reviewed(made.matches)
        counts = f"{sum(row.sure for row in made.matches)} of {counted(len(made.matches), 'shape')} taken."
        self._facts.setText(" ".join([counts, *made.notices]))
        self.table.setVisible(bool(rows))
        self._list(tuple(rows))

    def _list(self, rows: Sequence[Match]) -> None:
        if self._listed == rows:
            return
        self._listed = tuple(rows)
        self.boxes = {}
        self.table.setRowCount(len(rows))
        self.table.setFixedHeight(min(TABLE_PX, ROW_PX * (len(rows) + 1) + 6))
        for number, row in enumerate(rows):
            item = QTableWidgetItem(row.source)
            item.setToolTip(row.how)
            self.table.setItem(number, 0, item)
            box = self.boxes[row.source] = _box(f"What {row.source[:60]} is taken for", (LEFT_OUT, *SHAPES))
            box.setCurrentText(row.shape if row.sure else LEFT_OUT)
            box.setToolTip(row.how)
            box.activated.connect(lambda _, name=row.source: self._take(name))
            self.table.setCellWidget(number, 1, box)

    def _take(self, name: str) -> None:
        text = self.boxes[name].currentText()
        names = dict(self._retargeting.target.reading.names)
        self._retargeting.choosing.read_anew(names={**names, name: "" if text == LEFT_OUT else text})


class _Box(QComboBox):
    """A box that the wheel scrolls past: it stands in a list, and a choice by accident reads the head anew."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()


def _box(name: str, texts: Sequence[str]) -> QComboBox:
    box = _Box()
    box.addItems(list(texts))
    box.setAccessibleName(name)
    box.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return box


def _chosen(box: QComboBox) -> str:
    return "" if box.currentText() == FOUND else box.currentText()


def _degrees(box: QComboBox) -> float | None:
    return float(_chosen(box)) if _chosen(box) else None


def _turn(degrees: float | None) -> str:
    return "" if degrees is None else f"{degrees:g}"
