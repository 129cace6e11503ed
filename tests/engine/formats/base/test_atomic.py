"""What is written is whole, follows links, leaves devices and protected files alone, and leaves nothing beside it."""

from __future__ import annotations

import multiprocessing
import os
import stat
from pathlib import Path

import pytest

from engine.errors import EngineError
from engine.formats.base.atomic import PART, replacement, sweep, write_bytes
from engine.formats.base.owner import owner_mark


def test_a_link_is_followed_and_stays(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    target, link, link_to_link = tmp_path / "deep" / "take.csv", tmp_path / "link.csv", tmp_path / "second.csv"
    link.symlink_to(Path("deep") / "take.csv")
    link_to_link.symlink_to(link)
    write_bytes(link, [b"first"])  # what it leads to is not there yet
    assert target.read_bytes() == b"first"
    write_bytes(link_to_link, [b"second"])
    assert target.read_bytes() == b"second" and not target.is_symlink()
    assert link.is_symlink() and link_to_link.is_symlink()


def test_a_link_that_leads_nowhere_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "a.csv").symlink_to(tmp_path / "b.csv")
    (tmp_path / "b.csv").symlink_to(tmp_path / "a.csv")
    with pytest.raises(EngineError):
        write_bytes(tmp_path / "a.csv", [b"x"])
    assert (tmp_path / "a.csv").is_symlink()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes of Unix")
@pytest.mark.parametrize("what", ["device", "pipe", "folder", "link to a device"])
def test_only_plain_files_are_replaced(tmp_path: Path, what: str) -> None:
    path = tmp_path / "out.csv"
    if what == "device":
        path = Path(os.devnull)
    elif what == "pipe":
        os.mkfifo(path)
    elif what == "folder":
        path.mkdir()
    else:
        path.symlink_to(os.devnull)
    before = os.stat(path)
    with pytest.raises(EngineError, match=r"is not an ordinary file|is a folder"):
        write_bytes(path, [b"x"])
    assert os.stat(path).st_ino == before.st_ino and stat.S_IFMT(os.stat(path).st_mode) == stat.S_IFMT(before.st_mode)
    assert not list(tmp_path.glob(f".*{PART}"))


def test_a_write_protected_file_is_not_replaced(tmp_path: Path) -> None:
    path = tmp_path / "out.csv"
    path.write_bytes(b"kept")
    path.chmod(0o444)
    with pytest.raises(EngineError, match="write-protected"):
        write_bytes(path, [b"x"])
    assert path.read_bytes() == b"kept"
    path.chmod(0o640)
    write_bytes(path, [b"x"])
    assert path.read_bytes() == b"x" and stat.S_IMODE(path.stat().st_mode) == 0o640


def _write_until_killed(path: Path, ready: multiprocessing.synchronize.Event) -> None:
    with replacement(path) as temporary:
        temporary.write_bytes(b"half")
        ready.set()
        multiprocessing.Event().wait()


def test_what_a_kill_leaves_goes_with_the_next_write_and_what_runs_stays(tmp_path: Path) -> None:
    context = multiprocessing.get_context("spawn")
    ready = [context.Event() for _ in range(2)]
    dead, alive = [context.Process(target=_write_until_killed, args=(tmp_path / "a.csv", event)) for event in ready]
    for process in (dead, alive):
        process.start()
    try:
        assert all(event.wait(60) for event in ready)
        dead.kill()
        dead.join()
        (foreign := tmp_path / f".b.csv.{owner_mark().replace('-', 'x')}.part").write_bytes(b"somebody else's")
        assert len(list(tmp_path.glob(f".a.*{PART}"))) == 2
        write_bytes(tmp_path / "c.csv", [b"x"])
        assert len(list(tmp_path.glob(f".a.*{PART}"))) == 1 and foreign.exists()
    finally:
        alive.kill()
        alive.join()
    sweep(tmp_path)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == sorted(["c.csv", foreign.name])


@pytest.mark.parametrize("name", ["顔" * 80 + ".csv", "x" * 251 + ".csv", "😀" * 60 + ".csv"])
def test_long_names_are_written(tmp_path: Path, name: str) -> None:
    write_bytes(tmp_path / name, [b"x"])
    assert [entry.name for entry in tmp_path.iterdir()] == [name]


def test_the_folder_is_brought_to_the_disk_after_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[str] = []
    fsync, rename = os.fsync, os.replace

    def synced(descriptor: int) -> None:
        calls.append("folder" if stat.S_ISDIR(os.fstat(descriptor).st_mode) else "file")
        fsync(descriptor)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr(os, "replace", lambda *names: (calls.append("rename"), rename(*names)))
    write_bytes(tmp_path / "a.csv", [b"x"])
    assert calls == ["file", "rename", "folder"]
