from __future__ import annotations

import os
from pathlib import Path

import pytest

from engine.errors import EngineError
from engine.formats.base import inputs
from engine.formats.base.atomic import write_bytes
from engine.formats.base.content import content_of


def test_what_is_read_is_not_written_over_under_any_name(tmp_path: Path) -> None:
    path, link, second = tmp_path / "in.csv", tmp_path / "link.csv", tmp_path / "second.csv"
    path.write_bytes(b"kept")
    link.symlink_to(path)
    os.link(path, second)
    with inputs.protected():
        content_of(path)
        for name in (path, link, second, tmp_path / "." / "in.csv"):
            with pytest.raises(EngineError, match="what this command reads"):
                write_bytes(name, [b"x"])
        write_bytes(tmp_path / "out.csv", [b"x"])
    assert path.read_bytes() == b"kept"
    with inputs.protected(allowed=True):
        content_of(path)
        write_bytes(path, [b"x"])
    assert path.read_bytes() == b"x"


def test_protection_ends_with_the_command_and_one_within_another_begins_anew(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    for path in (one, other):
        path.write_bytes(b"")
    with inputs.protected():
        inputs.note(one)
        with inputs.protected():
            inputs.refuse(one)
            inputs.note(other)
        inputs.refuse(other)
        with pytest.raises(EngineError, match="one is what this command reads"):
            inputs.refuse(one)
    inputs.refuse(one)
    inputs.note(one)
    with inputs.protected():
        inputs.refuse(one)


def test_what_is_not_there_is_neither_noted_nor_refused(tmp_path: Path) -> None:
    with inputs.protected():
        for path in (tmp_path / "nowhere", Path("a\0b")):
            inputs.note(path)
            inputs.refuse(path)
        (tmp_path / "nowhere").write_bytes(b"")
        inputs.refuse(tmp_path / "nowhere")
        inputs.note(tmp_path)
        with pytest.raises(EngineError):
            inputs.refuse(tmp_path / ".")
