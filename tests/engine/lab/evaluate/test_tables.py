from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from engine.errors import EngineError
from engine.lab.evaluate.tables import TABLES, Table, named


def test_each_name_finds_its_table_and_another_none() -> None:
    assert [named(table.name) for table in TABLES] == list(TABLES)
    with pytest.raises(EngineError, match="no table called 'clea'"):
        named("clea")


def test_figures_go_to_a_folder_that_is_created_and_a_table_without_says_so(tmp_path: Path) -> None:
    drawn: list[Path | None] = []

    def figures(data: Path | None, folder: Path, report: object) -> list[Path]:
        assert folder.is_dir()
        drawn.append(data)
        return [folder / "a.png"]

    table = Table("a", "A table", lambda data, report: [], figures)
    assert table.draw(tmp_path, tmp_path / "new", print) == [tmp_path / "new" / "a.png"] and drawn == [tmp_path]
    with pytest.raises(EngineError, match="no figures"):
        replace(table, figures=None).draw(None, tmp_path / "other", print)
    assert not (tmp_path / "other").exists()
