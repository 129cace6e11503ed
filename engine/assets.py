"""The files that ship with the program: the head, the demo take, the trained networks and the icons."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

INSTALLED = "_assets"  # what a wheel calls the folder, inside the package
PACKAGE = Path(str(files("engine")))
CHECKOUT = PACKAGE.resolve().parent  # where the program is run from its sources
TEMPLATES = PACKAGE / "review"
RECORDINGS = CHECKOUT.parent / "shared" / "data"  # recorded takes beside a checkout


def _folder() -> Path:
    """Return the folder of assets: inside the package where it is installed, beside the package in a checkout."""
    inside = PACKAGE / INSTALLED
    return inside if inside.is_dir() else PACKAGE.parent / "assets"


ASSETS = _folder()
HEAD = ASSETS / "head" / "head.npz"
SECOND_HEAD = ASSETS / "head" / "second.npz"
DEMO_TAKE = ASSETS / "takes" / "demo.csv"
MODELS = ASSETS / "models"
ICONS = ASSETS / "icons"
