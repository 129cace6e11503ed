"""The file of what is remembered between starts."""

from __future__ import annotations

import getpass
import json
from pathlib import Path
from typing import TypeGuard

import platformdirs

from app.settings.log import NAME
from app.settings.presets import PRESETS

RECENT = 8
PLACES = 200  # of sound and video


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

    def _text(self, name: str, among: tuple[str, ...]) -> str:
        """Return a setting that is one of few, the first where the file says something else."""
        stored = str(self._stored.value(name, among[0]))
        return stored if stored in among else among[0]

    @property
    def theme(self) -> str:
        """The colours: dark, light, or as the system has it."""
        return self._text("theme", ("dark", "light", "system"))

    @theme.setter
    def theme(self, name: str) -> None:
        self._stored.setValue("theme", name)

    @property
    def count(self) -> str:
        """What the ruler counts in: timecode or frames."""
        return self._text("count", ("timecode", "frames"))

    @count.setter
    def count(self, name: str) -> None:
        self._stored.setValue("count", name)

    @property
    def preset(self) -> str:
        """Which program's shortcuts are used."""
        return self._text("preset", tuple(PRESETS))

    @preset.setter
    def preset(self, name: str) -> None:
        self._stored.setValue("preset", name)

    @property
    def keys(self) -> dict[str, tuple[str, ...]]:
        """The user's own shortcuts by action, which count before those of the preset."""
        return {name: tuple(str(key) for key in keys) for name, keys in self._mapping("keys").items() if _listed(keys)}

    @keys.setter
    def keys(self, keys: dict[str, tuple[str, ...]]) -> None:
        self._stored.setValue("keys", json.dumps(keys))

    @property
    def speaker(self) -> str:
        """Name of the loudspeaker to play on; empty for the system's own."""
        return str(self._stored.value("speaker", ""))

    @speaker.setter
    def speaker(self, name: str) -> None:
        self._stored.setValue("speaker", name)

    @property
    def scrubs(self) -> bool:
        """Whether the sound is heard while the playhead is moved."""
        return bool(self._stored.value("scrubs", True, type=bool))

    @scrubs.setter
    def scrubs(self, on: bool) -> None:
        self._stored.setValue("scrubs", on)

    @property
    def author(self) -> str:
        """Who writes notes; the name one is logged in by where none was typed."""
        return str(self._stored.value("author", "")) or _login()

    @author.setter
    def author(self, name: str) -> None:
        self._stored.setValue("author", name)

    @property
    def recent(self) -> list[str]:
        """Paths of the takes opened last, newest first."""
        stored = self._stored.value("recent", [])
        return [str(path) for path in (stored if isinstance(stored, list) else [stored]) if path][:RECENT]

    def remember(self, path: Path) -> None:
        """Put a path first among the recent ones."""
        self._stored.setValue("recent", [str(path), *(p for p in self.recent if p != str(path))][:RECENT])

    def forget_recent(self) -> None:
        """Remember no path any more."""
        self._stored.remove("recent")

    def place_of(self, content: str) -> Path | None:
        """Return where a file with this SHA-256 was last seen on this computer."""
        place = self._places().get(content)
        return Path(place) if place else None

    def remember_place(self, content: str, path: Path) -> None:
        """Remember where a file with this SHA-256 is: a project names only what lies beside it."""
        others = {key: place for key, place in self._places().items() if key != content}
        kept = dict([*others.items(), (content, str(path.absolute()))][-PLACES:])
        self._stored.setValue("places", json.dumps(kept))

    def _places(self) -> dict[str, str]:
        return {key: str(value) for key, value in self._mapping("places").items()}

    def _mapping(self, name: str) -> dict[str, object]:
        """Return what is stored as one JSON object; an empty one where it is none."""
        try:
            stored = json.loads(str(self._stored.value(name, "{}")))
        except (ValueError, RecursionError):
            return {}
        return stored if isinstance(stored, dict) else {}


def _listed(keys: object) -> TypeGuard[list[str]]:
    return isinstance(keys, list) and all(isinstance(key, str) for key in keys)


def _login() -> str:
    try:
        return getpass.getuser()
    except (OSError, KeyError, ImportError):
        return ""
