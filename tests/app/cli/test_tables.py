from __future__ import annotations

import json

import pytest

from app.cli.tables import show

ROWS = [
    {"method": name, "span_s": 0.5} | {f"figure_{index}": index + 0.1234 for index in range(9)}
    for name in ("ours", "another method")
]


def test_a_table_wider_than_the_terminal_goes_on_below(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    show("figures", ROWS, as_json=False)
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 60
    for index in range(9):
        heads = [line for line in lines if f"figure_{index} " in line]
        assert len(heads) == 1 and "method" in heads[0]
        assert sum(f" {index + 0.1234:.4g} " in line for line in lines) == len(ROWS)
    assert not any("…" in line for line in lines)


def test_figures_for_a_program_are_one_object(capsys: pytest.CaptureFixture[str]) -> None:
    show("figures", ROWS, as_json=True)
    assert json.loads(capsys.readouterr().out) == {"table": "figures", "rows": ROWS}


def test_a_table_of_nothing_is_no_error(capsys: pytest.CaptureFixture[str]) -> None:
    show("figures", [], as_json=False)
    assert capsys.readouterr().err == ""
