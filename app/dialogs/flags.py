"""Which kinds of flags count in a project, and from which thresholds; each applies at once, as one undo step."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDoubleSpinBox,
    QGridLayout,
    QHBoxLayout,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from app.dialogs.page import closing
from app.theme import GRID
from app.widgets.section import quiet
from app.widgets.text import tip
from engine.quality import TABLE, FlagSettings, Kind

WIDTH_PX, HEIGHT_PX, BOX_PX = 420, 560, 110
STEPS = 40  # from the lowest threshold to the highest


class FlagsDialog(QDialog):
    """A window of its own beside the work, which goes on.

    Parameters
    ----------
    settings : what is looked for
    parent : the window
    """

    changed = Signal(object, str)  # FlagSettings, what was set

    def __init__(self, settings: FlagSettings, parent: QWidget) -> None:
        super().__init__(parent)
        self._settings = settings
        self.setWindowTitle("Flags of this project")
        self.setModal(False)
        self.counts: dict[str, QCheckBox] = {}
        self.thresholds: dict[str, QDoubleSpinBox] = {}
        grid = QGridLayout()
        grid.setVerticalSpacing(GRID // 2)
        grid.setColumnStretch(0, 1)
        for row, kind in enumerate(TABLE):
            self._add(grid, row, kind)
        inner = QWidget()
        inner.setLayout(grid)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(inner)
        self.usual = QPushButton("As usual")
        self.usual.clicked.connect(lambda: self._set(FlagSettings(), "flags as usual"))
        foot = QHBoxLayout()
        foot.addWidget(self.usual)
        foot.addStretch(1)
        foot.addWidget(close := closing(self))
        for button in (self.usual, close):
            button.setAutoDefault(False)  # Enter ends what is typed, and presses nothing
        column = QVBoxLayout(self)
        column.setContentsMargins(2 * GRID, 2 * GRID, 2 * GRID, 2 * GRID)
        column.addWidget(quiet("What is looked for in this project, and from where on it is flagged."))
        column.addWidget(area, 1)
        column.addLayout(foot)
        self.resize(WIDTH_PX, HEIGHT_PX)
        self.show_settings(settings)

    def _add(self, grid: QGridLayout, row: int, kind: Kind) -> None:
        box = self.counts[kind.name] = QCheckBox(kind.title)
        box.setToolTip(tip(f"Usually: {kind.threshold}"))
        box.toggled.connect(partial(self._count, kind))
        grid.addWidget(box, row, 0)
        if kind.setting is None:
            return
        value = self.thresholds[kind.name] = QDoubleSpinBox()
        whole = kind.setting.unit == "frames"
        step = (kind.setting.highest - kind.setting.lowest) / STEPS
        value.setDecimals(0 if whole else 3 if step < 0.01 else 2)
        value.setRange(kind.setting.lowest, kind.setting.highest)
        value.setSingleStep(1 if whole else round(step, 3))
        value.setSuffix(f" {kind.setting.unit}")
        value.setKeyboardTracking(False)
        value.setFixedWidth(BOX_PX)
        value.setAccessibleName(f"Threshold of {kind.title}")
        value.setToolTip(tip(f"Usually: {kind.threshold}"))
        value.valueChanged.connect(partial(self._threshold, kind))
        grid.addWidget(value, row, 1)

    def show_settings(self, settings: FlagSettings) -> None:
        """Show what is looked for by now: it may have been undone."""
        self._settings = settings
        for kind in TABLE:
            with QSignalBlocker(self.counts[kind.name]):
                self.counts[kind.name].setChecked(settings.counted(kind))
            if kind.name in self.thresholds:
                with QSignalBlocker(self.thresholds[kind.name]):
                    self.thresholds[kind.name].setValue(settings.threshold(kind.name))
                self.thresholds[kind.name].setEnabled(settings.counted(kind))

    def _count(self, kind: Kind, on: bool) -> None:
        self._set(self._settings.with_count(kind.name, on=on), f"{'look' if on else 'do not look'} for: {kind.title}")

    def _threshold(self, kind: Kind, value: float) -> None:
        unit = kind.setting.unit if kind.setting is not None else ""
        self._set(self._settings.with_threshold(kind.name, value), f"{kind.title} from {value:g} {unit}".strip())

    def _set(self, settings: FlagSettings, title: str) -> None:
        if settings != self._settings:
            self.show_settings(settings)
            self.changed.emit(settings, title)
