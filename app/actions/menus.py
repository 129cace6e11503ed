"""Menus, toolbar and shortcuts, made from the table of actions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, QPoint, Qt
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QFrame, QHBoxLayout, QMainWindow, QMenu, QToolButton

from app.actions.table import ACTIONS, CONTEXT, LINES, MENUS, TOOLBAR, Action, all_keys
from app.settings import PRESETS, Settings
from app.theme import GRID
from app.widgets.hints import Hints
from app.widgets.text import caption, tip


class Menus(QObject):
    """Builds what the user can choose from.

    Parameters
    ----------
    window : gets the menu bar and owns the actions
    settings : remembers the preset and the recent files
    do : carries out an action by name
    load : opens a recent file

    Attributes
    ----------
    actions : by name
    hints : what the toolbar tells a newcomer
    """

    def __init__(
        self, window: QMainWindow, settings: Settings, do: Callable[[str], None], load: Callable[[Path], object]
    ) -> None:
        super().__init__(window)
        self._window, self._settings, self._load = window, settings, load
        self.actions: dict[str, QAction] = {}
        for entry in ACTIONS:
            action = QAction(entry.title, window, checkable=entry.checkable)
            action.setIconText(entry.short or entry.title)  # what a toolbar button shows
            action.triggered.connect(lambda _=False, name=entry.name: do(name))
            self.actions[entry.name] = action
        self._one_of([entry.name for entry in ACTIONS if entry.name.endswith("_tool")])
        self._one_of([entry.name for entry in ACTIONS if entry.name.startswith("view_")])
        self._menus: dict[str, QMenu] = {}
        for title in MENUS:
            menu = self._menus[title] = window.menuBar().addMenu(title)
            within: dict[str, QMenu] = {}
            for entry in ACTIONS:
                if entry.menu == title:
                    if entry.name in LINES:
                        menu.addSeparator()
                    _menu_of(entry, menu, within).addAction(self.actions[entry.name])
        self._recent = QMenu("Open recent", window)
        self._menus["File"].insertMenu(self.actions["save"], self._recent)
        self._recent.aboutToShow.connect(self._fill_recent)
        self.hints = Hints()
        self._offer_presets()

    def _one_of(self, names: Sequence[str]) -> None:
        """Group actions of which exactly one is checked: pressing the current tool's key again keeps the tool."""
        group = QActionGroup(self)
        for name in names:
            group.addAction(self.actions[name])

    def _offer_presets(self) -> None:
        menu = self._menus["View"].addMenu("Shortcuts")
        self._presets = QActionGroup(self)
        for name in PRESETS:
            action = self._presets.addAction(menu.addAction(name))
            action.setCheckable(True)
            action.triggered.connect(partial(self.use_preset, name))
        self.use_preset(self._settings.preset)

    def use_preset(self, name: str, *_: bool) -> None:
        """Use the shortcuts of a named program."""
        self._settings.preset = name
        for action in self._presets.actions():
            action.setChecked(action.text() == name)
        shortcuts = all_keys(name, self._settings.keys)
        for entry in ACTIONS:
            keys = shortcuts[entry.name]
            self.actions[entry.name].setShortcuts([QKeySequence(key) for key in keys])
            self.actions[entry.name].setToolTip(f"{entry.title}  ({keys[0]})" if keys else entry.title)

    def show_hints(self, *, changed: bool, saved: bool, hatched: bool) -> None:
        """Show how to begin; after the first edit how to undo, compare and save it; then nothing."""
        undo, save, play, fill = (self.actions[name].shortcut().toString() for name in ("undo", "save", "play", "fill"))
        begin = ["Drag a curve", f"{play} plays", *([f"{fill} fills what is hatched"] if hatched else [])]
        edited = [f"{undo} takes it back", f"{save} saves", "hold B for before"]
        self.hints.show_all(begin if not changed else [] if saved else edited)

    def _fill_recent(self) -> None:
        self._recent.clear()
        for name in self._settings.recent:
            entry = self._recent.addAction(caption(Path(name).name))
            entry.setToolTip(tip(name))
            entry.triggered.connect(partial(self._load, Path(name)))
        self._recent.setEnabled(bool(self._settings.recent))

    def open_context(self, kinds: Sequence[str], at: QPoint, heading: str = "") -> QMenu:
        """Offer what can be done with what lies at a point of the screen, kinds of `CONTEXT`, and say what it is."""
        menu = QMenu(self._window)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        if heading:
            menu.addAction(caption(heading)).setEnabled(False)
            menu.addSeparator()
        listed: set[str] = set()
        within: dict[str, QMenu] = {}
        entries = {entry.name: entry for entry in ACTIONS}
        for kind in kinds:
            for name in CONTEXT[kind]:
                if not name:
                    menu.addSeparator()
                elif name not in listed:
                    _menu_of(entries[name], menu, within).addAction(self.actions[name])
                    listed.add(name)
            menu.addSeparator()
        menu.popup(at)
        return menu

    def toolbar(self) -> QFrame:
        """Return the toolbar."""
        bar = QFrame()
        bar.setProperty("panel", True)
        row = QHBoxLayout(bar)
        row.setContentsMargins(GRID, 6, GRID, 6)
        row.setSpacing(4)
        titles = {entry.name: entry.title for entry in ACTIONS}
        for number, group in enumerate(TOOLBAR):
            if number:
                line = QFrame()
                line.setProperty("line", True)
                line.setFixedWidth(1)
                row.addSpacing(4)
                row.addWidget(line)
                row.addSpacing(4)
            for name in group:
                button = QToolButton()
                button.setProperty("tool", True)
                button.setDefaultAction(self.actions[name])
                button.setFocusPolicy(Qt.FocusPolicy.TabFocus)  # a click leaves the keys to the curves
                button.setAccessibleName(titles[name])
                row.addWidget(button)
        row.addWidget(self.hints, 1)
        return bar


def _menu_of(entry: Action, menu: QMenu, within: dict[str, QMenu]) -> QMenu:
    """Return the menu that an action goes into: `menu`, or the one inside it that the table names."""
    if not entry.submenu:
        return menu
    if entry.submenu not in within:
        within[entry.submenu] = menu.addMenu(entry.submenu)
    return within[entry.submenu]
