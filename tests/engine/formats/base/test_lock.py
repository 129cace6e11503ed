"""Locks tell who writes a file, after a kill too."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from engine.formats.base.atomic import write_bytes
from engine.formats.base.lock import FileLock
from engine.project import Contents, InUseError


def test_a_lock_that_a_kill_left_goes_with_the_next_write_and_others_stay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = "import os, sys; from pathlib import Path; from engine.formats.base.lock import FileLock; "
    code += "locks = [FileLock(Path(sys.argv[1]) / name) for name in ('a.retake', 'b.partial2.csv')]; os._exit(0)"
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=True)
    held = FileLock(tmp_path / "held.retake")
    (tmp_path / ".somebody.lock").write_text("else's")
    (tmp_path / ".c.retake.lock").touch()  # killed before its name was in it
    monkeypatch.setattr("engine.formats.base.lock.time.sleep", lambda _: None)
    assert len(list(tmp_path.iterdir())) == 5
    write_bytes(tmp_path / "c.csv", [b"x"])
    assert sorted(entry.name for entry in tmp_path.iterdir()) == [".held.retake.lock", ".somebody.lock", "c.csv"]
    assert held.held
    held.release()


def others(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.iterdir() if entry.is_file())


def owned_elsewhere(lock: Path, host: str) -> None:
    """Let a lock say that another computer has it, as after that one took it over."""
    fields = dict(line.partition("=")[::2] for line in lock.read_text().splitlines())
    fields |= {"host": host, "token": "f" * 32}
    text = "".join(f"{name}={value}\n" if value else f"{name}\n" for name, value in fields.items())
    (made := lock.with_suffix(".made")).write_text(text)
    os.replace(made, lock)


def test_a_lock_of_another_computer_counts_while_it_is_refreshed(
    contents: Contents, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.retake"
    held = FileLock(path)
    owned_elsewhere(lock := tmp_path / ".a.retake.lock", "other")
    turns = iter(range(1, 10**6))
    monkeypatch.setattr("engine.formats.base.lock.time.sleep", lambda _: os.utime(lock, (next(turns), next(turns))))
    with pytest.raises(InUseError, match="in Retake on other"):
        FileLock(path)
    assert not held.held  # as its own computer would find if it slept: somebody else's name is in it
    held.release()
    assert lock.exists()  # and it is not removed


def test_a_lock_that_another_computer_left_is_taken_over_after_a_lease(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, now = tmp_path / "a.retake", [0.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    monkeypatch.setattr("engine.formats.base.lock.time.sleep", lambda seconds: now.__setitem__(0, now[0] + seconds))
    left = FileLock(path)
    left._lease._stop_heartbeat()
    owned_elsewhere(tmp_path / ".a.retake.lock", "other")
    os.utime(tmp_path / ".a.retake.lock", (9e9, 9e9))  # its clock is far ahead
    taken = FileLock(path)
    assert taken.held and not left.held
    taken.release()


def test_a_lock_without_a_name_as_a_power_cut_leaves_it_is_nobodys(tmp_path: Path) -> None:
    (tmp_path / ".a.retake.lock").touch()
    lock = FileLock(tmp_path / "a.retake")
    assert lock.held
    lock.release()
    assert others(tmp_path) == []
