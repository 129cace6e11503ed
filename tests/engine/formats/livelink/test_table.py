from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.livelink.table import table

NAMES = ["Timecode", "Count", "a", "Note", "b", "c"]
WANTED = np.array([2, 4, 5])
HEAD = b"the names\n"


def read(rows: list[bytes], end: bytes = b"\n", first: int = len(HEAD)):
    return table(HEAD + end.join(rows) + end, first, (NAMES, WANTED), Path("a.csv"), None)


def a_row(rng: np.random.Generator, row: int) -> tuple[bytes, list[float] | None]:
    values = [round(float(value), int(rng.integers(0, 11))) for value in rng.normal(0, 30, 3)]
    if rng.random() < 0.3:
        count = str(rng.choice(["0", "0.0", " 0 ", "00", '"0"', "0."])).encode()
        more = [b"", b",", b",9,9,9,9", b",x,y"][int(rng.integers(4))]
        return b"%d," % row + count + more, None
    return f"{row} ,61,{values[0]},note {row},{values[1]},{values[2]}".encode(), values


@pytest.mark.parametrize("block_bytes", [1, 40, 1 << 18])
@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
def test_rows_are_split_as_a_plain_loop_splits_them(block_bytes: int, end: bytes, monkeypatch) -> None:
    monkeypatch.setattr("engine.formats.livelink.table.BLOCK_BYTES", block_bytes)
    rng = np.random.default_rng(2)
    made = [a_row(rng, row) for row in range(60)]
    timecodes, values, lost, starts = read([text for text, _ in made], end)
    assert timecodes == [b"%d" % row for row in range(60)]
    np.testing.assert_array_equal(lost, [numbers is None for _, numbers in made])
    assert values.shape == (60, 4) and not values[:, 1].any() and not values[lost].any()
    np.testing.assert_array_equal(values[~lost][:, [0, 2, 3]], [numbers for _, numbers in made if numbers is not None])
    lengths = [len(text) + len(end) for text, _ in made]
    np.testing.assert_array_equal(starts, len(HEAD) + np.cumsum([0, *lengths]))


GOOD = b"t,61,1,n,2,3"


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ([GOOD, b"t,61,1,n,2"], r"5 cells in row 3 where its header has 6\. The file may be cut off"),
        ([b"t,61,1,n,2,3,4", GOOD], r"7 cells in row 2 where its header has 6\.$"),
        ([GOOD, b"t"], "1 cells in row 3"),
        ([GOOD, b"0"], "1 cells in row 3"),
        ([b"t,0,1", GOOD, b"t,61,1,n,2x,3"], "'2x' for a number in row 4, column 5"),
        ([GOOD, b"t,61,,n,2,3"], "'' for a number in row 3, column 3"),
        ([GOOD, b"t,61,1,n,2," + b"9z" * 30], "'9z9z9z9z9z9z9z9z9z9z' for a number in row 3, column 6"),
        ([b"   ", b"\t"], "has a header but no frames"),
    ],
)
@pytest.mark.parametrize("block_bytes", [1, 1 << 18])
def test_what_is_wrong_is_named_with_its_row_and_column(rows, says: str, block_bytes: int, monkeypatch) -> None:
    monkeypatch.setattr("engine.formats.livelink.table.BLOCK_BYTES", block_bytes)
    with pytest.raises(FormatError, match=says):
        read(rows)


def test_the_share_that_is_read_is_told_block_by_block(monkeypatch) -> None:
    monkeypatch.setattr("engine.formats.livelink.table.BLOCK_BYTES", 1)
    heard: list[float] = []
    content = HEAD + (GOOD + b"\n") * 4
    table(content, len(HEAD), (NAMES, WANTED), Path("a.csv"), heard.append)
    stop = len(content) - 1
    assert heard == [(len(HEAD) + (row + 1) * (len(GOOD) + 1) - 1) / stop for row in range(4)]


def test_more_numbers_than_can_be_held_are_refused_and_blank_lines_at_the_end_are_nothing(monkeypatch) -> None:
    *_, starts = table(HEAD + GOOD + b"\r\n \n\n", len(HEAD), (NAMES, WANTED), Path("a.csv"), None)
    assert starts.tolist() == [len(HEAD), len(HEAD) + len(GOOD) + 2]
    monkeypatch.setattr("engine.formats.livelink.table.FEW_VALUES", 0)
    few = b"t,0\n" * 20  # 80 bytes that stand for 120 numbers
    with pytest.raises(FormatError, match="asks for"):
        table(HEAD + few, len(HEAD), (NAMES, WANTED), Path("a.csv"), None)
    assert len(table(HEAD + few, len(HEAD), (NAMES[:4], WANTED[:1]), Path("a.csv"), None)[0]) == 20
