from __future__ import annotations

import os
from pathlib import Path

from engine.project.held import hold, is_open, let_go


def test_a_file_is_open_under_all_its_names_until_each_holder_lets_go(tmp_path: Path) -> None:
    path, link, other = tmp_path / "a", tmp_path / "link", tmp_path / "b"
    path.touch()
    other.touch()
    os.link(path, link)
    assert not is_open(path)
    first, second = hold(path), hold(link)
    assert first == second is not None and is_open(path) and is_open(link) and not is_open(other)
    let_go(first)
    assert is_open(link)
    let_go(second)
    assert not is_open(path)
    let_go(second)  # once too often
    third = hold(path)
    assert is_open(path)
    let_go(third)
    assert not is_open(path)


def test_what_is_not_there_is_neither_held_nor_open(tmp_path: Path) -> None:
    assert hold(tmp_path / "nowhere") is None and not is_open(tmp_path / "nowhere") and not is_open(Path("a\0b"))
    let_go(None)
