"""Asking where to save: the name that is written is the very name that the user was asked about."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

Answer = QMessageBox.StandardButton


def ask_where(parent: QWidget, title: str, suggested: Path, kinds: Mapping[str, str]) -> Path | None:
    """Return the file that the user chose to write, or None.

    A name without one of the endings gets that of the kind which was chosen, and where this names a file that is there
    already, the user is asked about it: the dialog only asked about the name as it was typed.

    Parameters
    ----------
    kinds : what the user may choose from, by ending: ``{".csv": "Live Link Face CSV"}``; the first is the usual one
    """
    filters = {f"{kind} (*{ending})": ending for ending, kind in kinds.items()}
    while True:
        name, chosen = QFileDialog.getSaveFileName(parent, title, str(suggested), ";;".join(filters))
        if not name:
            return None
        path = Path(name)
        if path.suffix.lower() in kinds:
            return path
        path = path.with_name(path.name + filters.get(chosen, next(iter(kinds))))
        if not path.exists() or may_replace(parent, f"{path.name} is there already."):
            return path
        suggested = path


def may_replace(parent: QWidget, sentence: str) -> bool:
    """Ask whether a file may be replaced."""
    return QMessageBox.question(parent, "Replace it?", f"{sentence} Replace it?") == Answer.Yes
