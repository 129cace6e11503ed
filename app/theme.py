"""Colours, sizes and the style sheet: the only place that knows what anything looks like."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from engine import assets

if TYPE_CHECKING:
    from PySide6.QtGui import QPalette

GRID = 8  # px
ICONS = assets.ICONS.as_posix()
FONT_PX = 12
# Okabe and Ito's order, fit for every kind of colour vision; the last two are lightened for dark ground.
LANES = ("#56B4E9", "#E69F00", "#2BB88F", "#F0E442", "#CC79A7", "#E8743B", "#8FB4FF", "#B9BEC8")
LANES_ON_LIGHT = ("#0F73AE", "#9A6A00", "#007355", "#7A6F00", "#A0447A", "#B44A00", "#3D5FC4", "#4D5562")


@dataclass(frozen=True)
class Palette:
    """The colours of one theme, as #rrggbb."""

    ground: str
    panel: str
    edge: str
    raised: str
    text: str
    quiet: str
    faint: str
    accent: str
    on_accent: str
    warning: str
    good: str
    lanes: tuple[str, ...]
    check: str  # icon of a ticked box


DARK = Palette(
    ground="#14161a",
    panel="#1b1e24",
    edge="#2a2f38",
    raised="#262b34",
    text="#e3e6eb",
    quiet="#8b93a1",
    faint="#5a616d",
    accent="#56B4E9",
    on_accent="#0b1117",
    warning="#E69F00",
    good="#009E73",
    lanes=LANES,
    check="check",
)
LIGHT = Palette(
    ground="#e9ebef",
    panel="#fbfcfd",
    edge="#cfd4dc",
    raised="#eef0f4",
    text="#1c2026",
    quiet="#59616e",
    faint="#98a0ad",
    accent="#0F73AE",
    on_accent="#ffffff",
    warning="#9A6A00",
    good="#007355",
    lanes=LANES_ON_LIGHT,
    check="check_on_light",
)


def palette(name: str) -> Palette:
    """Return a theme by name: dark, light, or as the system has it."""
    if name == "system":
        from PySide6.QtCore import Qt
        from PySide6.QtGui import QGuiApplication

        name = "light" if QGuiApplication.styleHints().colorScheme() == Qt.ColorScheme.Light else "dark"
    return LIGHT if name == "light" else DARK


def qt_palette(colours: Palette) -> QPalette:
    """Return the colours of what no style sheet reaches, such as the bars of a list that drops down."""
    from PySide6.QtGui import QColor, QPalette

    role, colouring = QPalette.ColorRole, QPalette()
    for name, colour in (
        (role.Window, colours.ground),
        (role.Base, colours.panel),
        (role.AlternateBase, colours.raised),
        (role.Button, colours.raised),
        (role.ToolTipBase, colours.raised),
        (role.WindowText, colours.text),
        (role.Text, colours.text),
        (role.ButtonText, colours.text),
        (role.ToolTipText, colours.text),
        (role.PlaceholderText, colours.quiet),
        (role.Highlight, colours.accent),
        (role.HighlightedText, colours.on_accent),
        (role.Light, colours.edge),
        (role.Midlight, colours.edge),
        (role.Mid, colours.edge),
        (role.Dark, colours.ground),
        (role.Shadow, colours.ground),
    ):
        colouring.setColor(name, QColor(colour))
    for name in (role.WindowText, role.Text, role.ButtonText):
        colouring.setColor(QPalette.ColorGroup.Disabled, name, QColor(colours.faint))
    return colouring


def style_sheet(colours: Palette) -> str:
    """Return the Qt style sheet of a theme."""
    parts = (_ground, _buttons, _entries, _menus, _bars)
    return "".join(part(colours) for part in parts) + "\n"


def _ground(c: Palette) -> str:
    """Return the style of windows, panels and labels."""
    return f"""
* {{ font-size: {FONT_PX}px; color: {c.text}; }}
QMainWindow, QDialog, QWidget#central {{ background: {c.ground}; }}
QFrame[panel="true"] {{ background: {c.panel}; border: 1px solid {c.edge}; border-radius: 6px; }}
QLabel, QCheckBox {{ background: transparent; border: none; }}
QLabel[quiet="true"] {{ color: {c.quiet}; }}
QLabel[heading="true"] {{ font-weight: 600; }}
QLabel[warning="true"] {{ color: {c.warning}; }}"""


def _buttons(c: Palette) -> str:
    """Return the style of buttons, sliders and boxes to tick."""
    return f"""
QToolButton, QPushButton {{
  background: transparent; border: 1px solid transparent; border-radius: 4px; padding: 5px 10px; }}
QPushButton {{ background: {c.raised}; }}
QToolButton:hover, QPushButton:hover {{ background: {c.edge}; }}
QToolButton:checked, QPushButton[primary="true"] {{ background: {c.accent}; color: {c.on_accent}; }}
QToolButton[segment="true"]:checked {{ background: {c.edge}; color: {c.text}; }}
QToolButton:disabled, QPushButton:disabled {{ color: {c.faint}; }}
QToolButton[tool="true"] {{ padding: 5px 8px; }}
QPushButton:checked {{ border: 1px solid {c.accent}; }}
QToolButton:focus, QPushButton:focus, QCheckBox:focus, QSlider:focus {{ border: 1px solid {c.accent}; }}
QToolButton:checked:focus, QPushButton[primary="true"]:focus {{ border: 1px solid {c.text}; }}
QToolButton::menu-indicator {{ image: none; }}
QFrame[line="true"] {{ background: {c.edge}; border: none; }}
QSlider::groove:horizontal {{ height: 4px; background: {c.edge}; border-radius: 2px; }}
QSlider::sub-page:horizontal {{ background: {c.accent}; border-radius: 2px; }}
QSlider::handle:horizontal {{ width: 12px; height: 12px; margin: -4px 0; border-radius: 6px; background: {c.text}; }}
QSlider {{ border: 1px solid transparent; border-radius: 4px; min-height: 18px; }}
QCheckBox::indicator {{
  width: 12px; height: 12px; border: 1px solid {c.quiet}; border-radius: 3px; background: {c.ground}; }}
QCheckBox::indicator:checked {{ background: {c.accent}; border-color: {c.accent}; image: url("{ICONS}/{c.check}.svg"); }}
QCheckBox {{ border: 1px solid transparent; border-radius: 4px; padding: 2px; spacing: 8px; }}"""


def _entries(c: Palette) -> str:
    """Return the style of entries, boxes and lists."""
    return f"""
QDoubleSpinBox, QSpinBox, QLineEdit, QComboBox, QPlainTextEdit, QListView, QTreeView, QTableView {{
  background: {c.ground}; border: 1px solid {c.edge}; border-radius: 4px; padding: 3px 6px;
  selection-background-color: {c.accent}; selection-color: {c.on_accent}; }}
QDoubleSpinBox:focus, QSpinBox:focus, QLineEdit:focus, QComboBox:focus, QPlainTextEdit:focus, QListView:focus,
QTreeView:focus, QTableView:focus {{ border-color: {c.accent}; }}
QAbstractSpinBox::up-button, QAbstractSpinBox::down-button {{ width: 0; border: none; }}
QComboBox::drop-down {{ border: none; width: 20px; }}
QComboBox::down-arrow {{ image: url("{ICONS}/down.svg"); width: 10px; height: 6px; }}
QComboBox QAbstractItemView {{ background: {c.panel}; border: 1px solid {c.edge}; border-radius: 0; padding: 0; }}
QComboBoxPrivateContainer, QComboBoxPrivateScroller {{ background: {c.panel}; border: none; }}
QTableView QComboBox {{ padding: 1px 2px 1px 4px; }}
QTableView QComboBox::drop-down {{ width: 14px; }}
QFileDialog QToolButton {{ padding: 2px; }}
QDialogButtonBox {{ dialogbuttonbox-buttons-have-icons: 0; }}
QHeaderView {{ background: {c.panel}; }}
QHeaderView::section {{ background: {c.panel}; color: {c.quiet}; border: none; padding: 3px 6px; }}"""


def _menus(c: Palette) -> str:
    """Return the style of menus and tooltips."""
    return f"""
QMenuBar {{ background: {c.ground}; }}
QMenuBar::item {{ padding: 4px 8px; background: transparent; }}
QMenuBar::item:selected {{ background: {c.raised}; border-radius: 4px; }}
QMenu {{ background: {c.panel}; border: 1px solid {c.edge}; padding: 4px; }}
QMenu::item {{ padding: 5px 24px 5px 12px; border-radius: 4px; }}
QMenu::item:selected {{ background: {c.edge}; }}
QMenu::item:disabled {{ color: {c.faint}; }}
QMenu::separator {{ height: 1px; background: {c.edge}; margin: 4px 8px; }}
QToolTip {{ background: {c.raised}; color: {c.text}; border: 1px solid {c.edge}; padding: 4px; }}"""


def _bars(c: Palette) -> str:
    """Return the style of scroll bars, splitters and bars of progress."""
    return f"""
QScrollBar:horizontal {{ height: 10px; background: transparent; margin: 0; }}
QScrollBar::handle:horizontal {{ background: {c.edge}; border-radius: 4px; min-width: 24px; margin: 1px; }}
QScrollBar:vertical {{ width: 10px; background: transparent; margin: 0; }}
QScrollBar::handle:vertical {{ background: {c.edge}; border-radius: 4px; min-height: 24px; margin: 1px; }}
QScrollBar::handle:disabled {{ background: transparent; }}
QScrollBar::handle:hover:!disabled {{ background: {c.faint}; }}
QScrollBar::add-line, QScrollBar::sub-line, QScrollBar::add-page, QScrollBar::sub-page {{
  background: transparent; border: none; width: 0; height: 0; }}
QScrollArea, QScrollArea > QWidget > QWidget {{ background: transparent; border: none; }}
QSplitter::handle {{ background: transparent; }}
QProgressBar {{ background: {c.ground}; border: 1px solid {c.edge}; border-radius: 4px; text-align: center; height: 14px; }}
QProgressBar::chunk {{ background: {c.accent}; border-radius: 3px; }}
QFrame#banner {{ background: {c.raised}; border: 1px solid {c.warning}; border-radius: 6px; }}"""
