"""What a right click or the menu key offers: the actions on what lies there, made from the table."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QPoint
from PySide6.QtWidgets import QMenu

from app.preview.panel import VIEWS

if TYPE_CHECKING:
    from app.window.main_window import MainWindow


class Contexts(QObject):
    """Opens the menu that a panel wants.

    Parameters
    ----------
    window : whose panels and actions they are

    Attributes
    ----------
    menu : the one that was opened last
    """

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window
        self.menu: QMenu | None = None
        window.timeline.menu_wanted.connect(self._open)
        window.curves.menu_wanted.connect(self._open)
        for kind, source in (
            ("face", window.preview.face),
            ("span", window.spans),
            ("note", window.notes),
            ("flag", window.flags),
            ("label", window.retarget.panel.labels),
        ):
            source.menu_wanted.connect(partial(self._open, kind))
        window.preview.view_changed.connect(self._show_view)
        self._show_view(window.preview.face.view)

    def kinds_here(self) -> list[str]:
        """Return the kinds of things at the playhead, those one would look for first in front."""
        session, frame = self._window.session, self._window.session.view.playhead
        there = {
            "note": any(note.frame == frame for note in session.document.marks.notes),
            "pin": any(pin.frame == frame for pin in session.document.marks.pins),
            "span": self._window.spans.chosen is not None,
        }
        return [*(kind for kind, is_there in there.items() if is_there), "curve"]

    def _open(self, kind: str, at: QPoint, heading: str = "") -> None:
        kinds = self.kinds_here() if kind == "here" else [kind]
        self.menu = self._window.menus.open_context(kinds, at, heading or self._told(kind))
        self.menu.destroyed.connect(self._forget)

    def _forget(self) -> None:
        self.menu = None

    def _told(self, kind: str) -> str:
        """Return what is wrong at the playhead, for a flag of the list."""
        return self._window.flags.here.text().partition("\n")[0] if kind == "flag" else ""

    def _show_view(self, name: str) -> None:
        for view in VIEWS:
            self._window.actions_by_name[f"view_{view.lower()}"].setChecked(view == name)
