"""What is remembered between starts, and where the log is."""

from __future__ import annotations

import logging
from logging.handlers import RotatingFileHandler
from pathlib import Path

import platformdirs

NAME = "Retake"
RECENT = 8


def log_path() -> Path:
    """Return the path of the log file."""
    return Path(platformdirs.user_log_dir(NAME, appauthor=False)) / "retake.log"


def start_log() -> None:
    """Write warnings and worse to the log file; a folder that cannot be written is no reason to stop."""
    try:
        log_path().parent.mkdir(parents=True, exist_ok=True)
        handler = RotatingFileHandler(log_path(), maxBytes=1_000_000, backupCount=2, encoding="utf-8", delay=True)
    except OSError:
        return
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s"))
    logging.getLogger().addHandler(handler)


class Settings:
    """Typed access to the settings file.

    Parameters
    ----------
    path : of the file; the user's own without one
    """

    def __init__(self, path: Path | None = None) -> None:
        from PySide6.QtCore import QSettings  # here, so that commands can log without loading Qt

        folder = Path(platformdirs.user_config_dir(NAME, appauthor=False))
        self._stored = QSettings(str(path or folder / "retake.ini"), QSettings.Format.IniFormat)

    @property
    def light(self) -> bool:
        """Whether the light theme is on."""
        return bool(self._stored.value("light", False, type=bool))

    @light.setter
    def light(self, on: bool) -> None:
        self._stored.setValue("light", on)

    @property
    def preset(self) -> str:
        """Which program's shortcuts are used."""
        return str(self._stored.value("preset", "Retake"))

    @preset.setter
    def preset(self, name: str) -> None:
        self._stored.setValue("preset", name)

    @property
    def recent(self) -> list[str]:
        """Paths of the takes opened last, newest first."""
        stored = self._stored.value("recent", [])
        return [str(path) for path in (stored if isinstance(stored, list) else [stored]) if path][:RECENT]

    def remember(self, path: Path) -> None:
        """Put a path first among the recent ones."""
        self._stored.setValue("recent", [str(path), *(p for p in self.recent if p != str(path))][:RECENT])
