"""How the target head was read: the meaning of its shapes, its unit and its axes, each to be corrected."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QCheckBox, QComboBox, QGridLayout, QHeaderView, QTableWidget, QTableWidgetItem, QWidget

from app.retarget.retargeting import Retargeting
from app.session import Session
from app.widgets.section import Section, quiet
from app.widgets.text import tip
from engine.formats.characters.frame import UNITS_MM, UPS
from engine.formats.characters.names import Match, reviewed
from engine.take import SHAPES
from engine.words import counted

LEFT_OUT = "left out"
FOUND = "as found"
FACINGS = tuple(str(turn) for turn in (0, 45, 90, 135, 180, -135, -90, -45))
TABLE_PX, ROW_PX = 210, 24
MEANING_PX = 116  # of the column with the boxes


class HeadSection(Section):
    """Lists the shapes that want a look, and how the file's coordinates were read; each choice reads the head anew.

    Parameters
    ----------
    session : whose tool is at work
    retargeting : whose target it is

    Attributes
    ----------
    table : the file's names, and a box with the meaning of each
    boxes : the boxes, by the file's name
    all_shapes : whether those without doubt are listed too
    unit, up, facing : of the file
    """

    tools = frozenset({"retarget"})

    def __init__(self, session: Session, retargeting: Retargeting) -> None:
        super().__init__(session, "Imported head")
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
        self.table.setHorizontalHeaderLabels(["Shape", "Meaning"])
        self.table.setAccessibleName("Shapes of the head")
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(ROW_PX)
        header = self.table.horizontalHeader()
        header.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(1, QHeaderView.ResizeMode.Fixed)
        header.resizeSection(1, MEANING_PX)
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
        imported, refused = state.target.imported, state.choosing.refused
        reading = refused[1] if refused else state.target.reading
        self.needed = imported is not None or refused is not None
        self.setVisible(self.needed and self.session.view.tool in self.tools)
        for part in (self._frame, self.table, self.all_shapes):
            part.setVisible(imported is not None or (refused is not None and part is self._frame))
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
        if imported is None:
            return
        rows = imported.matches if self.all_shapes.isChecked() else reviewed(imported.matches)
        counts = f"{sum(row.sure for row in imported.matches)} of {counted(len(imported.matches), 'shape')} matched."
        self._facts.setText(" ".join([counts, *imported.notices]))
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
            item.setToolTip(tip(f"{row.source}: {row.how}"))
            self.table.setItem(number, 0, item)
            box = self.boxes[row.source] = _box(f"Meaning of {row.source[:60]}", (LEFT_OUT, *SHAPES))
            box.setCurrentText(row.shape if row.sure else LEFT_OUT)
            box.setToolTip(row.how)
            box.activated.connect(lambda _, name=row.source: self._take(name))
            self.table.setCellWidget(number, 1, box)

    def _take(self, name: str) -> None:
        text = self.boxes[name].currentText()
        names = dict(self._retargeting.target.reading.names)
        self._retargeting.choosing.read_anew(names={**names, name: "" if text == LEFT_OUT else text})


class _Box(QComboBox):
    """A box that ignores the wheel: in a scrolled list, an accidental choice would read the head again."""

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
