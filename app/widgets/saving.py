"""Asking where to save: the name that is written is the very name that the user was asked about."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

Answer = QMessageBox.StandardButton


def beside(opened: Path | None, name: str) -> Path:
    """Return a name in the folder of what is open; the program's own demo take is no place to save to."""
    from engine.assets import DEMO_TAKE

    return (opened.parent if opened is not None and opened != DEMO_TAKE else Path.home()) / name


def ask_where(parent: QWidget, title: str, suggested: Path, kinds: Mapping[str, str]) -> tuple[Path | None, str]:
    """Return the file that the user chose to write, or None, and the kind that was chosen.

    A name without one of the endings gets that of the kind which was chosen, and where this names a file that is there
    already, the user is asked about it: the dialog only asked about the name as it was typed.

    Parameters
    ----------
    kinds : the ending by what the user may choose from: ``{"Live Link Face CSV (*.csv)": ".csv"}``; usual first
    """
    while True:
        name, kind = QFileDialog.getSaveFileName(parent, title, str(suggested), ";;".join(kinds))
        path = Path(name)
        if not name:
            return None, kind
        if path.suffix.lower() in kinds.values():
            return path, kind
        path = path.with_name(path.name + kinds.get(kind, next(iter(kinds.values()))))
        if not path.exists() or may_replace(parent, f"{path.name} is there already."):
            return path, kind
        suggested = path


def may_replace(parent: QWidget, sentence: str) -> bool:
    """Ask whether a file may be replaced."""
    return QMessageBox.question(parent, "Replace it?", f"{sentence} Replace it?") == Answer.Yes
