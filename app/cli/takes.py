"""`retake info`, `retake edit` and `retake render`: what is done with one take."""

from __future__ import annotations

import typer


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
