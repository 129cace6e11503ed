"""Where the program's own folders are, and the log in one of them."""

from __future__ import annotations

import logging
from logging.handlers import RotatingFileHandler
from pathlib import Path

import platformdirs

NAME = "Retake"  # what its folders are called


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
