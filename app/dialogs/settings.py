"""The settings: each applies at once, and nothing waits for the dialog to be closed."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QGridLayout,
    QHBoxLayout,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from app.background import LatestWins
from app.dialogs.page import closing
from app.playback import device
from app.playback.media import Media
from app.settings import PRESETS, Settings
from app.theme import GRID
from app.widgets.section import heading, quiet
from engine.words import counted, plain, plural

THEMES = {"Dark": "dark", "Light": "light", "As the system": "system"}
COUNTS = {"Timecode": "timecode", "Frames": "frames"}
SYSTEMS_OWN = "The system's own"
WIDTH_PX = 400


class SettingsDialog(QDialog):
    """A window of its own beside the work, which goes on.

    Parameters
    ----------
    settings : what is shown and changed
    media : tells what plays
    parent : the window
    """

    changed = Signal(str)  # name of the setting
    edit_keys = Signal()

    def __init__(self, settings: Settings, media: Media, parent: QWidget) -> None:
        super().__init__(parent)
        self._settings, self._media = settings, media
        self._speakers: list[str] = []
        self.setWindowTitle("Settings")
        self.setModal(False)
        self.setFixedWidth(WIDTH_PX)
        self.theme, self.preset, self.count, self.speaker = (QComboBox() for _ in range(4))
        self.theme.addItems(list(THEMES))
        self.preset.addItems(list(PRESETS))
        self.count.addItems(list(COUNTS))
        self.speaker.addItem(SYSTEMS_OWN)
        self.scrubs = QCheckBox("Hear the sound while scrubbing")
        self.playing, self.recent = quiet(""), quiet("")
        self.author = QLineEdit()
        self.author.setPlaceholderText("Your name in notes")
        self.keys = QPushButton("Change keys…")
        self.keys.clicked.connect(self.edit_keys)
        self.clear = QPushButton("Clear")
        self.clear.setAccessibleName("Clear recent files")
        self._lay_out()
        self._connect()
        self._asking = LatestWins(lambda _: device.names(), name="loudspeakers")  # some systems take a second to tell
        self._asking.done.connect(self._show_speakers)

    def _lay_out(self) -> None:
        grid = QGridLayout()
        grid.setHorizontalSpacing(2 * GRID)
        grid.setVerticalSpacing(GRID)
        grid.setColumnStretch(1, 1)
        rows: tuple[tuple[str, tuple[tuple[str, QWidget], ...]], ...] = (
            ("Look", (("Theme", self.theme), ("Ruler counts in", self.count))),
            ("Keys", (("Shortcuts of", self.preset), ("", self.keys))),
            ("Sound", (("Plays on", self.speaker), ("", self.scrubs), ("", self.playing))),
            ("Notes", (("Author", self.author),)),
        )
        at = 0
        for title, settings in rows:
            grid.addWidget(heading(title), at, 0, 1, 2)
            at += 1
            for name, widget in settings:
                grid.addWidget(quiet(name), at, 0)
                grid.addWidget(widget, at, 1)
                if name:
                    widget.setAccessibleName(name)
                at += 1
            grid.setRowMinimumHeight(at, GRID)
            at += 1
        grid.addWidget(heading("Recent files"), at, 0, 1, 2)
        row = QHBoxLayout()
        row.addWidget(self.recent, 1)
        row.addWidget(self.clear)
        grid.addLayout(row, at + 1, 0, 1, 2)
        column = QVBoxLayout(self)
        column.setContentsMargins(3 * GRID, 2 * GRID, 3 * GRID, 2 * GRID)
        column.addLayout(grid)
        column.addSpacing(GRID)
        column.addWidget(closing(self), alignment=Qt.AlignmentFlag.AlignRight)

    def _connect(self) -> None:
        self.theme.textActivated.connect(lambda text: self._set("theme", THEMES[text]))
        self.count.textActivated.connect(lambda text: self._set("count", COUNTS[text]))
        self.preset.textActivated.connect(lambda text: self._set("preset", text))
        self.speaker.textActivated.connect(lambda text: self._set("speaker", "" if text == SYSTEMS_OWN else text))
        self.scrubs.toggled.connect(lambda on: self._set("scrubs", on))
        self.author.editingFinished.connect(lambda: self._set("author", self.author.text().strip()))
        self.clear.clicked.connect(self._forget)
        self._media.device_changed.connect(self._show_playing)

    def refresh(self) -> None:
        """Show what the settings are by now."""
        settings = self._settings
        for box, names, value in (
            (self.theme, THEMES, settings.theme),
            (self.count, COUNTS, settings.count),
            (self.preset, {name: name for name in PRESETS}, settings.preset),
        ):
            box.setCurrentIndex(list(names.values()).index(value))
        with QSignalBlocker(self.scrubs):
            self.scrubs.setChecked(settings.scrubs)
        self.author.setText(settings.author)
        self._list_speakers()
        self._show_playing()
        self._show_recent()

    def showEvent(self, event: QShowEvent) -> None:
        """Ask which loudspeakers there are."""
        super().showEvent(event)
        self.refresh()
        self._asking.submit(None)

    def event(self, event: QEvent) -> bool:
        """Show what was changed elsewhere, when one comes back to the dialog."""
        if event.type() == QEvent.Type.WindowActivate:
            self.refresh()
        return bool(super().event(event))

    def close_thread(self) -> None:
        """End the thread that asks for loudspeakers."""
        self._asking.stop()

    def _set(self, name: str, value: object) -> None:
        if getattr(self._settings, name) != value:
            setattr(self._settings, name, value)
            self.changed.emit(name)

    def _forget(self) -> None:
        self._settings.forget_recent()
        self._show_recent()

    def _show_recent(self) -> None:
        count = len(self._settings.recent)
        self.recent.setText(f"{counted(count, 'file')} {plural(count, 'is', 'are')} remembered.")
        self.clear.setEnabled(count > 0)

    def _show_speakers(self, _: object, names: list[str]) -> None:
        self._speakers = names
        self._list_speakers()

    def _list_speakers(self) -> None:
        """List the loudspeakers; the one that was chosen stays in the list while it is unplugged."""
        wanted = self._settings.speaker
        self.speaker.clear()
        self.speaker.addItems(list(dict.fromkeys([SYSTEMS_OWN, *self._speakers, *([wanted] if wanted else [])])))
        self.speaker.setCurrentText(wanted or SYSTEMS_OWN)

    def _show_playing(self) -> None:
        if not self._media.attached:
            self.playing.setText("No sound is attached to this take.")
        elif self._media.device:
            self.playing.setText(f"Playing on {plain(self._media.device)}.")
        else:
            self.playing.setText("No loudspeaker was found: playback is silent.")
