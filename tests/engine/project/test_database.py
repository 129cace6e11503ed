from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from engine import project
from engine.project import Contents, Project


def test_a_project_that_is_written_while_it_is_read_is_read_whole(
    contents: Contents, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, copied = tmp_path / "a.retake", shutil.copyfile
    alive = project.create(path, contents)
    turns = iter(range(3))

    def written_meanwhile(source: Path, target: Path) -> None:
        copied(source, target)
        if str(source).endswith(".retake") and (turn := next(turns, None)) is not None:
            alive.put(replace(alive.contents, position=turn))

    monkeypatch.setattr("engine.project.database.shutil.copyfile", written_meanwhile)
    assert Project.open(path, read_only=True).contents.position == 2
    alive.close()
