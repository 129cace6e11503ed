"""What this is, and the versions it runs on."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

from app.settings import log_path

LIBRARIES = ("PySide6-Essentials", "pyqtgraph", "pyrender", "torch", "numpy")


def describe() -> str:
    """Return name, versions and where the log is, as lines of text."""
    lines = [f"Retake {_version('retake')}", "Edit a facial performance without reshooting it.", ""]
    lines += [f"Python {platform.python_version()} on {platform.system()} {platform.machine()}"]
    lines += [f"{name} {_version(name)}" for name in LIBRARIES]
    return "\n".join([*lines, "", f"Log: {log_path()}"])


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "(not installed)"
