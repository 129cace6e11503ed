from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

from engine import project
from engine.project import Contents, DisplacedError
from tests.engine.project.projects import reopened


def test_a_project_that_was_merely_touched_or_renamed_back_is_written(contents: Contents, tmp_path: Path) -> None:
    path = tmp_path / "a.retake"
    opened = project.create(path, contents)
    os.utime(path, (1.0, 1.0))  # a clock that was set back
    opened.put(replace(contents, position=2))
    path.rename(tmp_path / "b.retake")
    with pytest.raises(DisplacedError, match="moved or deleted"):
        opened.put(replace(contents, position=1))
    (tmp_path / "b.retake").rename(path)
    opened.put(replace(contents, position=1))
    opened.close()
    assert reopened(path).position == 1


def test_who_lost_the_lock_while_asleep_writes_no_more(contents: Contents, tmp_path: Path) -> None:
    path = tmp_path / "a.retake"
    slept = project.create(path, contents)
    owned_elsewhere(tmp_path / ".a.retake.lock", "other")
    before = path.read_bytes()
    with pytest.raises(DisplacedError, match="another computer meanwhile"):
        slept.put(replace(contents, position=1))
    slept.close()
    assert path.read_bytes() == before and (tmp_path / ".a.retake.lock").exists()


def owned_elsewhere(lock: Path, host: str) -> None:
    """Let a lock say that another computer has it, as after that one took it over."""
    fields = dict(line.partition("=")[::2] for line in lock.read_text().splitlines())
    fields |= {"host": host, "token": "f" * 32}
    text = "".join(f"{name}={value}\n" if value else f"{name}\n" for name, value in fields.items())
    (made := lock.with_suffix(".made")).write_text(text)
    os.replace(made, lock)
