"""The study of people left out in the model card; `retake train regress_study` runs it anew."""

from __future__ import annotations

from pathlib import Path

from engine.lab.evaluate.study import stored
from engine.lab.reporting import Report, Row


def table(data: Path | None, report: Report) -> list[Row]:
    """Return the stored rows; they were measured on the recorded takes, whatever `data` names."""
    if data is not None:
        report("this study is of the recorded takes; --data changes nothing")
    return stored("people")
