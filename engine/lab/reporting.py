"""What trainings and tables say while they run, and what a table holds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Report = Callable[[str], None]  # hears one line of progress at a time
Row = dict[str, Any]  # "method" or "name", then the metrics as plain numbers
