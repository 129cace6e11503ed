from __future__ import annotations

import os
from pathlib import Path

import pytest

from engine.errors import EngineError
from engine.project import spares
from engine.project.spares import drop, make, recover


@pytest.fixture
def project(tmp_path: Path) -> Path:
    path = tmp_path / "a b\udcff.retake"
    path.write_bytes(b"steps")
    return path


def test_a_second_name_holds_the_file_and_says_whose_it_is(project: Path, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "unsaved"
    one, other = make(project, folder), make(project, folder)
    assert one != other and os.path.samefile(one, project) and one.suffix == ".spare"
    assert one.with_suffix(".of").read_text("utf-8", "surrogateescape") == str(project)
    project.unlink()
    assert one.read_bytes() == b"steps"
    drop(one)
    drop(one)
    assert sorted(folder.iterdir()) == sorted([other, other.with_suffix(".of")])


def test_only_what_programs_left_that_run_no_more_is_recovered(project: Path, tmp_path: Path, monkeypatch) -> None:
    folder, seen = tmp_path / "unsaved", []
    spare = make(project, folder)
    for runs, told in ((True, 0), (None, 0), (False, 1)):
        monkeypatch.setattr(
            spares, "owner_runs", lambda mark, runs=runs: runs if mark == spare.name.split(".")[0] else True
        )
        recover(folder, lambda *both: seen.append(both))
        assert seen == [(spare, project)] * told
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("error", [EngineError("in use"), OSError("gone")])
def test_what_cannot_be_put_in_order_stays_for_another_time(
    project: Path, tmp_path: Path, monkeypatch, error: Exception
) -> None:
    spare = make(project, tmp_path / "unsaved")
    monkeypatch.setattr(spares, "owner_runs", lambda _: False)

    def tidy(*_: Path) -> None:
        raise error

    recover(tmp_path / "unsaved", tidy)
    assert spare.exists() and spare.with_suffix(".of").exists()
