"""What is remembered between starts, the shortcuts there are to choose from, and the log."""

from app.settings.log import NAME, log_path, start_log
from app.settings.presets import PRESETS
from app.settings.stored import Settings

__all__ = ["NAME", "PRESETS", "Settings", "log_path", "start_log"]
