from __future__ import annotations

import os
from pathlib import Path

from engine.project.open_files import is_open, register, release


def test_a_file_is_open_under_all_its_names_until_each_holder_lets_go(tmp_path: Path) -> None:
    path, link, other = tmp_path / "a", tmp_path / "link", tmp_path / "b"
    path.touch()
    other.touch()
    os.link(path, link)
    assert not is_open(path)
    first, second = register(path), register(link)
    assert first == second is not None and is_open(path) and is_open(link) and not is_open(other)
    release(first)
    assert is_open(link)
    release(second)
    assert not is_open(path)
    release(second)  # once too often
    third = register(path)
    assert is_open(path)
    release(third)
    assert not is_open(path)


def test_what_is_not_there_is_neither_held_nor_open(tmp_path: Path) -> None:
    assert register(tmp_path / "nowhere") is None and not is_open(tmp_path / "nowhere") and not is_open(Path("a\0b"))
    release(None)
