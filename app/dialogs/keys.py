"""The keys of every action: change one, see whom it is taken from, go back to the preset's."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import (
    QDialog,
    QHBoxLayout,
    QHeaderView,
    QKeySequenceEdit,
    QLineEdit,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from app.dialogs.page import closing
from app.settings import Settings
from app.theme import GRID
from app.widgets.section import quiet

WIDTH_PX, HEIGHT_PX = 520, 560
Keys = Mapping[str, tuple[str, ...]]


@dataclass(frozen=True)
class KeyRow:
    """An action: its name, and its title and menu as one reads them."""

    name: str
    title: str
    menu: str


class KeysDialog(QDialog):
    """Lists the actions; the chosen one gets the key that is pressed, at once.

    Parameters
    ----------
    rows : the actions
    all_keys : the keys of all actions, by name, where some have keys of the user's own
    settings : keep the user's own keys
    parent : the window

    Attributes
    ----------
    search : what is typed narrows the list
    table : action, menu and keys, one row for each of `rows`
    entry : the key to give to the chosen action
    remark : what was changed, or whose the key is already
    take : gives the key to the chosen action and takes it from the other
    reset, reset_all : go back to the preset
    """

    changed = Signal()

    def __init__(
        self,
        rows: Sequence[KeyRow],
        all_keys: Callable[[Keys], Keys],
        settings: Settings,
        parent: QWidget,
    ) -> None:
        super().__init__(parent)
        self._rows, self._all_keys, self._settings = tuple(rows), all_keys, settings
        self._cells = [QTableWidgetItem() for _ in self._rows]
        self.setWindowTitle("Keys")
        self.setModal(False)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.resize(WIDTH_PX, HEIGHT_PX)
        self.search, self.table, self.entry = QLineEdit(), QTableWidget(len(self._rows), 3), QKeySequenceEdit()
        self.remark = quiet("Choose an action, then press its new key.")
        self.take, self.remove = QPushButton("Use it here instead"), QPushButton("No key")
        self.reset, self.reset_all = QPushButton("Reset"), QPushButton("Reset all")
        self._lay_out()
        self._connect()
        self._show_keys()
        self._choose()

    def _lay_out(self) -> None:
        self.search.setPlaceholderText("Search actions and keys…")
        self.search.setClearButtonEnabled(True)
        self.table.setHorizontalHeaderLabels(["Action", "Menu", "Keys"])
        self.table.verticalHeader().hide()
        self.table.setShowGrid(False)
        self.table.setSelectionBehavior(QTableWidget.SelectionBehavior.SelectRows)
        self.table.setSelectionMode(QTableWidget.SelectionMode.SingleSelection)
        self.table.setEditTriggers(QTableWidget.EditTrigger.NoEditTriggers)
        self.table.horizontalHeader().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.table.setAccessibleName("Actions and their keys")
        for number, row in enumerate(self._rows):
            self.table.setItem(number, 0, QTableWidgetItem(row.title))
            self.table.setItem(number, 1, QTableWidgetItem(row.menu))
            self.table.setItem(number, 2, self._cells[number])
        self.entry.setAccessibleName("New key")
        self.entry.setMaximumSequenceLength(1)
        self.entry.setClearButtonEnabled(True)
        column = QVBoxLayout(self)
        column.setContentsMargins(2 * GRID, 2 * GRID, 2 * GRID, 2 * GRID)
        column.setSpacing(GRID)
        first, last = QHBoxLayout(), QHBoxLayout()
        for widget in (self.entry, self.take, self.remove, self.reset):
            first.addWidget(widget)
        last.addWidget(self.reset_all)
        last.addStretch(1)
        last.addWidget(closing(self))
        column.addWidget(self.search)
        column.addWidget(self.table, 1)
        column.addLayout(first)
        column.addWidget(self.remark)
        column.addLayout(last)

    def _connect(self) -> None:
        self.search.textChanged.connect(self._narrow)
        self.table.currentCellChanged.connect(lambda *_: self._choose())
        self.entry.keySequenceChanged.connect(self._typed)
        self.take.clicked.connect(self._take)
        self.remove.clicked.connect(self._remove)
        self.reset.clicked.connect(self._reset)
        self.reset_all.clicked.connect(self._reset_all)

    @property
    def chosen(self) -> KeyRow | None:
        """The action whose key is changed."""
        row = self.table.currentRow()
        return self._rows[row] if 0 <= row < len(self._rows) else None

    def owner(self, key: str) -> KeyRow | None:
        """Return the action that has a key, other than the chosen one."""
        wanted, keys = QKeySequence(key), self._all_keys(self._settings.keys)
        for row in self._rows:
            if row is not self.chosen and any(QKeySequence(each) == wanted for each in keys[row.name]):
                return row
        return None

    def _choose(self) -> None:
        there = self.chosen is not None
        for widget in (self.entry, self.remove, self.reset):
            widget.setEnabled(there)
        self.entry.clear()
        self.take.hide()

    def _typed(self, sequence: QKeySequence) -> None:
        """Give the key to the chosen action, or say whose it is already."""
        key, chosen = sequence.toString(), self.chosen
        self.take.hide()
        if not key or chosen is None:
            return
        other = self.owner(key)
        if other is None:
            self._give(key)
        else:
            self.remark.setText(f"{key} is used by {other.title}.")
            self.take.show()

    def _give(self, key: str, taken_from: KeyRow | None = None) -> None:
        chosen = self.chosen
        assert chosen is not None
        own = self._settings.keys
        if taken_from is not None:
            had = self._all_keys(own)[taken_from.name]
            own[taken_from.name] = tuple(each for each in had if QKeySequence(each) != QKeySequence(key))
        own[chosen.name] = (key,)
        self._put(own, f"{chosen.title} is {key} now.")

    def _take(self) -> None:
        key = self.entry.keySequence().toString()
        self._give(key, self.owner(key))

    def _remove(self) -> None:
        if (chosen := self.chosen) is not None:
            self._put({**self._settings.keys, chosen.name: ()}, f"{chosen.title} has no key now.")

    def _reset(self) -> None:
        """Go back to the preset's keys for the chosen action, save those that the user gave to another."""
        if (chosen := self.chosen) is not None:
            own = {name: keys for name, keys in self._settings.keys.items() if name != chosen.name}
            self._put(own, f"{chosen.title} is as in the preset.")

    def _reset_all(self) -> None:
        self._put({}, f"All keys are as in the preset {self._settings.preset}.")

    def _put(self, own: dict[str, tuple[str, ...]], remark: str) -> None:
        self._settings.keys = own
        self.take.hide()
        self.remark.setText(remark)
        self._show_keys()
        self.changed.emit()

    def _show_keys(self) -> None:
        own = self._settings.keys
        keys = self._all_keys(own)
        for row, cell in zip(self._rows, self._cells, strict=True):
            cell.setText(", ".join(keys[row.name]))
            font = cell.font()
            font.setBold(row.name in own)
            cell.setFont(font)
        self._narrow(self.search.text())

    def _narrow(self, text: str) -> None:
        wanted = text.strip().lower()
        for number, row in enumerate(self._rows):
            shown = f"{row.title} {row.menu} {self._cells[number].text()}".lower()
            self.table.setRowHidden(number, wanted not in shown)
