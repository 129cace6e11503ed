"""The files that ship with the program: the head, the demo take, the trained networks and the icons."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

INSTALLED = "_assets"  # what a wheel calls the folder, inside the package


def _folder() -> Path:
    """Return the folder of assets: inside the package where it is installed, beside the package in a checkout."""
    package = Path(str(files("engine")))
    inside = package / INSTALLED
    return inside if inside.is_dir() else package.parent / "assets"


ASSETS = _folder()
HEAD = ASSETS / "head" / "head.npz"
SECOND_HEAD = ASSETS / "head" / "second.npz"
DEMO_TAKE = ASSETS / "takes" / "demo.csv"
MODELS = ASSETS / "models"
ICONS = ASSETS / "icons"
