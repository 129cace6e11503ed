from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest

from engine.errors import FormatError
from engine.formats.markers import read


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_short_rows_below_many_columns_do_not_fill_memory(separator: str, tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    header = separator.join(f"m{marker}_{axis}" for marker in range(4_000) for axis in "xyz")
    path.write_text(header + "\n" + "1\n" * 20_000)
    tracemalloc.start()
    with pytest.raises(FormatError, match=r"asks for 240,000,000 numbers"):
        read(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 32e6


def test_more_columns_or_rows_than_a_capture_has_are_refused_unread(tmp_path: Path) -> None:
    (tmp_path / "wide.csv").write_text(";".join(f"m{marker}_x" for marker in range(20_000)) + "\n")
    with pytest.raises(FormatError, match="too many columns"):
        read(tmp_path / "wide.csv")
    (tmp_path / "long.csv").write_text("a_x,a_y,a_z\n" + "\n" * 3_000_000)
    with pytest.raises(FormatError, match="frames"):
        read(tmp_path / "long.csv")
