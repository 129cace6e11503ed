"""The actions about the program itself: settings, which apply at once, the list of keys, and what this is."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QWidget

from app import theme
from app.actions.menus import Menus
from app.actions.table import ACTIONS, MENUS, MOUSE, all_keys
from app.dialogs.keys import KeyRow, KeysDialog
from app.dialogs.page import Page, in_columns, in_lines
from app.dialogs.settings import SettingsDialog
from app.playback.media import Media
from app.settings import Settings


class SettingsActions(QObject):
    """Each public method without arguments is an action of the table.

    Parameters
    ----------
    settings : what is remembered
    menus, media : what settings change
    window : the parent of the dialogs
    """

    themed = Signal(object)  # Palette
    counted = Signal(bool)  # whether time is told in frames

    def __init__(self, settings: Settings, menus: Menus, media: Media, window: QWidget) -> None:
        super().__init__()
        self._settings, self._menus, self._media, self._window = settings, menus, media, window
        self._dialog: SettingsDialog | None = None
        QGuiApplication.styleHints().colorSchemeChanged.connect(self._follow_system)

    def show_settings(self) -> None:
        """Show the settings beside the work."""
        if self._dialog is None:
            self._dialog = SettingsDialog(self._settings, self._media, self._window)
            self._dialog.changed.connect(self.apply)
            self._dialog.edit_keys.connect(self.edit_keys)
        self._dialog.show()
        self._dialog.raise_()

    def edit_keys(self) -> None:
        """Show the keys of every action, to be changed."""
        rows = [KeyRow(entry.name, entry.words, entry.menu) for entry in ACTIONS]
        dialog = KeysDialog(rows, lambda own: all_keys(self._settings.preset, own), self._settings, self._window)
        dialog.changed.connect(partial(self.apply, "keys"))
        dialog.show()

    def light_theme(self) -> None:
        """Switch between dark and light."""
        self._settings.theme = "light" if self._menus.actions["light_theme"].isChecked() else "dark"
        self.apply("theme")

    def show_keys(self) -> None:
        """List every key."""
        keys = all_keys(self._settings.preset, self._settings.keys)
        groups = {
            menu: [
                (entry.words, ", ".join(keys[entry.name]))
                for entry in ACTIONS
                if entry.menu == menu and keys[entry.name]
            ]
            for menu in MENUS
        }
        groups["View"].append(("See the original", "hold B"))
        groups["Mouse"] = list(MOUSE)
        Page("Keys", in_columns(groups), self._window).show()

    def about(self) -> None:
        """Say what this is and which versions it runs on."""
        from app.dialogs.about import describe

        name, *rest = describe().split("\n")
        Page("About Retake", in_lines(name, rest), self._window).show()

    def apply_all(self) -> None:
        """Let every setting take effect."""
        for name in ("theme", "count", "speaker", "scrubs"):
            self.apply(name)

    def apply(self, name: str) -> None:
        """Let a setting take effect."""
        settings = self._settings
        if name == "theme":
            colours = theme.palette(settings.theme)
            self._menus.actions["light_theme"].setChecked(colours is theme.LIGHT)
            self.themed.emit(colours)
        elif name == "count":
            self.counted.emit(settings.count == "frames")
        elif name in ("preset", "keys"):
            self._menus.use_preset(settings.preset)
        elif name == "speaker":
            self._media.use_device(settings.speaker)
        elif name == "scrubs":
            self._media.scrub_aloud(settings.scrubs)

    def close(self) -> None:
        """End the dialog's thread."""
        QGuiApplication.styleHints().colorSchemeChanged.disconnect(self._follow_system)
        if self._dialog is not None:
            self._dialog.close_thread()

    def _follow_system(self) -> None:
        if self._settings.theme == "system":
            self.apply("theme")
