from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.markers import read
from engine.formats.markers.text import decoded, lines_of, numbers


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


def test_numbers_are_read_as_a_plain_loop_reads_them_block_by_block(monkeypatch) -> None:
    rng = np.random.default_rng(0)
    table = np.where(rng.random((50, 4)) < 0.3, np.nan, np.round(rng.normal(0, 99, (50, 4)), 4))
    lines = [b";".join(b"" if np.isnan(cell) else b"%.4f" % cell for cell in row) for row in table]
    lines[3], table[3] = b"1;2", [1, 2, np.nan, np.nan]
    lines[7], table[7] = b" ;2;3;4; ;", [np.nan, 2, 3, 4]
    for block in (1, 13, 10**6):
        monkeypatch.setattr("engine.formats.markers.text.BLOCK", block)
        np.testing.assert_array_equal(numbers(lines, 4, separator=b";", first_row=2, path=Path("a.csv")), table)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        (b"1,2,3,x", "has 'x' for a number in row 12, column 4"),
        (b"1,2,3,4,5", "has 5 cells in row 12 where its header has 4"),
        (b"1,inf,3,4", "infinite number in row 12, column 2"),
        (b"1,-inf,3,4", "infinite number in row 12, column 2"),
        (b"1,2 3,3,4", "for a number in row 12, column 2"),
    ],
)
@pytest.mark.parametrize("block", [1, 8, 10**6])
def test_a_cell_that_is_no_number_is_named(line: bytes, says: str, block: int, monkeypatch) -> None:
    monkeypatch.setattr("engine.formats.markers.text.BLOCK", block)
    lines = [b"1,2,3,4"] * 5 + [line] + [b"1,2,3,4"] * 3
    with pytest.raises(FormatError, match=says):
        numbers(lines, 4, separator=b",", first_row=7, path=Path("a.csv"))


def test_lines_come_without_their_ends_and_what_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"\xef\xbb\xbfa,b\r\n1,2\n\n3,4\r\n\n \n")
    assert lines_of(path, "") == [b"a,b", b"1,2", b"", b"3,4"]
    for content, says in ((b" \r\n", "is empty"), (b"", "is empty"), (b"a\0b\n", "not a text file")):
        path.write_bytes(content)
        with pytest.raises(FormatError, match=says):
            lines_of(path, "")
    path.write_bytes(b"x" * (512 * 1024) + b"\0")
    assert len(lines_of(path, "")) == 1


def test_headers_are_utf_8_or_western_letters(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    assert decoded("Lèvre;x".encode(), path, "") == decoded("Lèvre;x".encode("cp1252"), path, "") == "Lèvre;x"
    with pytest.raises(FormatError, match="not a text file"):
        decoded(b"\xff\x81", path, "")
    for mark in (b",", b"\t", b";"):
        assert decoded(mark * (3 * 4096), path, "")
        with pytest.raises(FormatError, match="too many columns"):
            decoded(mark * (3 * 4096 + 1), path, "")
    assert decoded(b"x" * (512 * 1024), path, "")
    with pytest.raises(FormatError, match="too many columns"):
        decoded(b"x" * (512 * 1024 + 1), path, "")
