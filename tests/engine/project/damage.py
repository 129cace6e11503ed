"""Damage to a project file, and what it is made of."""

from __future__ import annotations

import json
import zlib
from pathlib import Path

import pytest

from engine.errors import FormatError
from engine.project import Project
from tests.engine.project.projects import sql


def damaged(whole: bytes, path: Path, *statements: str, values: tuple[object, ...] = ()) -> str:
    path.write_bytes(whole)
    sql(path, *statements, values=values)
    with pytest.raises(FormatError) as caught:
        Project.open(path)
    assert path.name in caught.value.sentence and "Traceback" not in str(caught.value)
    return caught.value.sentence


def marked(**marks: object) -> str:
    whole = {"spans": [], "pins": [], "notes": [], "media": [], "verdict": ""}
    return json.dumps({"before": whole, "after": {**whole, **marks}})


def zeros(count: int) -> bytes:
    return zlib.compress(bytes(count))
