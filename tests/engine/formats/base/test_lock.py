"""Locks tell who writes a file, after a kill too."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from engine.formats.base.atomic import write_bytes
from engine.formats.base.lock import FileLock, InUseError, drop_abandoned


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
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
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


def test_one_program_has_a_file_at_a_time_and_gives_it_back(tmp_path: Path) -> None:
    path = tmp_path / "a.retake"
    first = FileLock(path)
    assert first.held and others(tmp_path) == [".a.retake.lock"]
    with pytest.raises(InUseError, match=r"a\.retake is open in another Retake"):
        FileLock(path)
    first.release()
    assert not first.held and others(tmp_path) == []
    again = FileLock(path)
    assert again.held and not first.held
    again.release()


def test_a_folder_that_is_not_there_gets_no_lock(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        FileLock(tmp_path / "nowhere" / "a.retake")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("length", "hashed"), [(249, False), (250, True), (255, True)])
def test_the_lock_of_a_long_name_is_called_by_its_hash(tmp_path: Path, length: int, hashed: bool) -> None:
    path = tmp_path / ("x" * (length - len(".retake")) + ".retake")
    lock = FileLock(path)
    (name,) = others(tmp_path)
    assert lock.held and len(name) <= 255
    assert bool(re.fullmatch(r"\.[0-9a-f]{16}\.lock", name)) == hashed
    lock.release()


@pytest.mark.parametrize(
    ("name", "dropped"),
    [
        (".a.retake.lock", True),
        (".take.partial.csv.lock", True),
        (".take.partial7.csv.lock", True),
        (".0123456789abcdef.lock", True),
        (".0123456789abcde.lock", False),
        (".other.lock", False),
        ("a.retake.lock", False),
    ],
)
def test_only_locks_of_our_own_names_are_looked_at(tmp_path: Path, name: str, dropped: bool, monkeypatch) -> None:
    monkeypatch.setattr("engine.formats.base.lock.time.sleep", lambda _: None)
    (tmp_path / name).touch()
    drop_abandoned(tmp_path / name)
    assert (tmp_path / name).exists() != dropped


def test_a_lock_that_gets_its_name_within_a_moment_stays(tmp_path: Path, monkeypatch) -> None:
    lock = tmp_path / ".a.retake.lock"
    lock.touch()
    monkeypatch.setattr("engine.formats.base.lock.time.sleep", lambda _: os.utime(lock, (5, 5)))
    drop_abandoned(lock)
    assert lock.exists()
    held = FileLock(tmp_path / "b.retake")
    drop_abandoned(tmp_path / ".b.retake.lock")
    assert held.held
    held.release()
