"""Which vertex of the target carries which marker: a list, and clicks on the target's face."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QCheckBox, QComboBox, QListWidget, QListWidgetItem, QPushButton

from app.retarget.placing import Placing
from app.retarget.retargeting import Retargeting
from app.retarget.target import Target
from app.session import Session
from app.widgets.section import Section, quiet
from app.widgets.text import tip
from engine.editing import MARKERS
from engine.formats.characters.marker_table import MarkerMatch
from engine.words import NAME_LENGTH, plain

LIST_PX = 190
ELSEWHERE = "left out"


def _state(name: str, target: Target, taken: MarkerMatch | None) -> str:
    """Return what the list says of a marker beside its name."""
    if name in target.by_hand:
        return "by hand"
    if name not in target.places:
        return "left out" if taken is not None and taken.how == "left out" else "not placed"
    if taken is None or taken.how == "by name":
        return ""
    return f"{taken.landmark or 'between landmarks'}" + (f", {taken.away_mm:.0f} mm off" if taken.away_mm else "")


class PlacesSection(Section):
    """Lists the source's markers; the chosen one goes where the target is clicked.

    Parameters
    ----------
    session : whose tool is at work
    retargeting, placing : keep the places, and change them

    Attributes
    ----------
    show_dots : whether the markers are drawn on both heads
    list : of markers, in the source's order
    rest_button, remove_button, save_button, read_button : for the window's actions
    """

    tools = frozenset({"retarget"})

    def __init__(self, session: Session, retargeting: Retargeting, placing: Placing) -> None:
        super().__init__(session, "Markers")
        self._retargeting, self._placing = retargeting, placing
        self.show_dots = QCheckBox("Show and place")
        self.show_dots.setToolTip("Draw the markers on both heads, and place them by clicking the target")
        self.column.addWidget(self.show_dots)
        self._facts = quiet("")
        self.column.addWidget(self._facts)
        self.list = QListWidget()
        self.list.setFixedHeight(LIST_PX)
        self.list.setAccessibleName("Markers")
        self.list.currentItemChanged.connect(self._choose)
        self.column.addWidget(self.list)
        self.landmark = QComboBox()
        self.landmark.addItems([ELSEWHERE, *MARKERS])
        self.landmark.setAccessibleName("Landmark of the chosen marker")
        self.landmark.setToolTip("Which place of a face the chosen marker is; it was found by its position at rest")
        self.landmark.activated.connect(self._mean)
        self.column.addWidget(self.landmark)
        self.rest_button, self.remove_button = QPushButton("Place the others"), QPushButton("Remove")
        self.rest_button.setToolTip("Markers that were not placed by hand follow those that were")
        self.save_button, self.read_button = QPushButton("Save…"), QPushButton("Read…")
        self.side_by_side(self.rest_button, self.remove_button)
        self.side_by_side(self.save_button, self.read_button)
        self._inner = (self.list, self.rest_button, self.remove_button, self.save_button, self.read_button)
        self.show_dots.toggled.connect(lambda _: self._retargeting.changed.emit())
        retargeting.changed.connect(self.show_all)
        self.show_all()

    def show_all(self) -> None:
        """Show the markers as they are."""
        names, target = self._retargeting.names, self._retargeting.target
        shown = self.show_dots.isChecked() and target.head is not None
        self.setEnabled(target.head is not None)
        for widget in self._inner:
            widget.setVisible(shown)
        placed = sum(name in target.places for name in names)
        self._facts.setText(
            f"{placed} of {len(names)} on the target, {len(target.by_hand)} by hand." + self._guessed()
            if target.head is not None
            else "Choose a head first."
        )
        with QSignalBlocker(self.list):
            if [self.list.item(row).data(0x100) for row in range(self.list.count())] != list(names):
                self.list.clear()
                for name in names:
                    item = QListWidgetItem(self.list)
                    item.setData(0x100, name)
            taken = {row.marker: row for row in target.markers.rows} if self._retargeting.capture is not None else {}
            for row, name in enumerate(names):
                state = _state(name, target, taken.get(name))
                item = self.list.item(row)
                item.setText(f"{row + 1}  {plain(name, longest=NAME_LENGTH)}" + (f"  · {state}" if state else ""))
                item.setToolTip(tip(item.text()))  # the panel is narrow, and studios' names are long
                item.setForeground(QColor("#E69F00") if state == "not placed" else self.palette().text().color())
            chosen = self._placing.chosen
            self.list.setCurrentRow(names.index(chosen) if chosen in names else -1)
        self.landmark.setVisible(shown and bool(taken) and bool(chosen))
        with QSignalBlocker(self.landmark):
            self.landmark.setCurrentText(target.markers.landmarks.get(chosen, "") or ELSEWHERE)

    def _guessed(self) -> str:
        rows = self._retargeting.target.markers.rows if self._retargeting.capture is not None else ()
        found = sum(row.how == "by place" and bool(row.landmark) for row in rows)
        return f" {found} were found by their position at rest: check them." if found else ""

    def _mean(self, _: int) -> None:
        text = self.landmark.currentText()
        self._placing.mean("" if text == ELSEWHERE else text)

    def _choose(self, item: QListWidgetItem | None) -> None:
        if item is not None:
            self._placing.choose(item.data(0x100))
