from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from engine.errors import EngineError
from engine.formats import livelink, read_take
from engine.formats.base.reading import Reading
from engine.lab.performer import demo
from engine.take import SHAPES, Take

DEMO = demo.BUNDLED.read_bytes()


def written(tmp_path: Path, content: bytes) -> Path:
    path = tmp_path / "täke.csv"
    path.write_bytes(content)
    return path


def test_reading_and_writing_changes_no_byte(tmp_path: Path) -> None:
    take = read_take(demo.BUNDLED)
    livelink.write(take, tmp_path / "copy.csv")
    assert (tmp_path / "copy.csv").read_bytes() == DEMO


def test_real_take_round_trip(real_take_path: Path, tmp_path: Path) -> None:
    for path in sorted(real_take_path.parent.glob("*.csv")):
        livelink.write(livelink.read(path), tmp_path / path.name)
        assert (tmp_path / path.name).read_bytes() == path.read_bytes(), path.name


def test_a_take_without_origin_survives(random_take: Take, tmp_path: Path) -> None:
    livelink.write(random_take, tmp_path / "new.csv")
    again = livelink.read(tmp_path / "new.csv")
    assert again.fps == random_take.fps
    np.testing.assert_allclose(again.weights, random_take.weights, atol=1e-10)


def test_lost_rows_are_marked_never_zero() -> None:
    take = read_take(demo.BUNDLED)
    assert 20 <= take.lost.sum() <= 30
    assert np.abs(np.diff(take.weights[take.lost], axis=0)).max() < 0.1


def test_left_and_right_of_the_mouth_are_exchanged(tmp_path: Path) -> None:
    swapped = livelink.read(demo.BUNDLED)
    plain = livelink.read(demo.BUNDLED, reading=Reading(sides="named"))
    np.testing.assert_array_equal(swapped.curve("mouthLeft"), plain.curve("mouthRight"))


def rows_of(timecodes: list[str]) -> bytes:
    head = ",".join(livelink.DEFAULT_HEADER)
    body = ",".join(["61", *["0.5"] * 61])
    return "\n".join([head, *[f"{timecode},{body}" for timecode in timecodes]]).encode()


@pytest.mark.parametrize(
    ("timecodes", "fps", "frames"),
    [
        ([f"10:00:00:{2 * i:06.3f}" for i in range(20)], 30.0, 20),
        ([f"10:00:00:{i:06.3f}" for i in range(20)], 60.0, 20),
        ([f"10:00:00:{2 * i:06.3f}" for i in range(20) if i != 7], 30.0, 20),
        (["23:59:59:56.000", "23:59:59:58.000", "00:00:00:00.000", "00:00:00:02.000"], 30.0, 4),
        ([f"00:00:{i:02d}:00" for i in range(20)], 30.0, 20),
        (["nonsense"] * 5, 30.0, 5),
    ],
)
def test_rate_is_told_by_the_timecodes(tmp_path: Path, timecodes: list[str], fps: float, frames: int) -> None:
    take = livelink.read(written(tmp_path, rows_of(timecodes)))
    assert (take.fps, len(take)) == (fps, frames)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "empty"),
        (DEMO[: len(DEMO) // 2], "cells in row"),
        (
            DEMO.replace(b",61,", b",61,nan,", 1).replace(b",0.0000000000\n", b"\n", 1),
            "not a finite number in row 2, column 3",
        ),
        (DEMO.replace(b",61,", b",61,oops", 1), "in row 2, column 3"),
        (b"hello\nworld\n", "does not begin"),
        (b"a," * 10**6 + b"\n", "too many columns"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR\x00\xff", "not a text file"),
        (DEMO.split(b"\n")[0] + b"\n", "no frames"),
        (DEMO.replace(b"JawOpen", b"Jaw"), "lacks the column jawOpen"),
    ],
)
def test_bad_files_get_one_sentence(tmp_path: Path, content: bytes, says: str) -> None:
    with pytest.raises(EngineError, match=says) as caught:
        livelink.read(written(tmp_path, content))
    assert "täke.csv" in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("block_bytes", [1, 700, 5000])
def test_a_file_is_read_the_same_in_any_blocks(monkeypatch: pytest.MonkeyPatch, block_bytes: int) -> None:
    whole = livelink.read(demo.BUNDLED)
    monkeypatch.setattr("engine.formats.livelink.table.BLOCK_BYTES", block_bytes)
    shares: list[float] = []
    pieces = livelink.read(demo.BUNDLED, shares.append)
    for name in ("weights", "rotations", "lost"):
        np.testing.assert_array_equal(getattr(pieces, name), getattr(whole, name))
    np.testing.assert_array_equal(pieces.origin.starts, whole.origin.starts)
    assert pieces.fps == whole.fps
    assert shares == sorted(shares) and shares[-1] == 1.0 and len(shares) > 10


@pytest.mark.parametrize("row", [2, 3, 50, 200])
@pytest.mark.parametrize(
    ("put", "says"),
    [
        (lambda cells: [*cells[:9], b"1,5", *cells[10:]], "64 cells in row {row} where its header has 63"),
        (lambda cells: cells[:-1], "62 cells in row {row}"),
        (lambda cells: [], "1 cells in row {row}"),
        (lambda cells: cells[:2], "2 cells in row {row}"),
        (lambda cells: [*cells[:9], b"0.1x", *cells[10:]], "'0.1x' for a number in row {row}, column 10"),
        (lambda cells: [*cells[:-1], b""], "'' for a number in row {row}, column 63"),
    ],
)
def test_a_damaged_cell_is_named_in_any_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, row: int, put: Callable[[list[bytes]], list[bytes]], says: str
) -> None:
    monkeypatch.setattr("engine.formats.livelink.table.BLOCK_BYTES", 5000)
    for newline in (b"\n", b"\r\n"):
        lines = [line for line in DEMO.split(b"\n") if line and not line.endswith(b",0")]
        lines[row - 1] = b",".join(put(lines[row - 1].split(b",")))
        with pytest.raises(EngineError, match=says.format(row=row)):
            livelink.read(written(tmp_path, newline.join(lines)))


def test_reading_ends_where_the_listener_says_so() -> None:
    def stop(share: float) -> None:
        raise EngineError("Enough.")

    with pytest.raises(EngineError, match="Enough"):
        livelink.read(demo.BUNDLED, stop)


@pytest.mark.parametrize("tail", [b"\n\n\n", b"\r\n \t\n", b" " * 2_000_000])
def test_blank_rows_at_the_end_are_nothing(tmp_path: Path, tail: bytes) -> None:
    assert len(livelink.read(written(tmp_path, DEMO + tail))) == len(livelink.read(demo.BUNDLED))


def test_one_frame_is_a_take(tmp_path: Path) -> None:
    assert len(livelink.read(written(tmp_path, rows_of(["10:00:00:00.000"])))) == 1


def test_shapes_are_the_arkit_52() -> None:
    assert len(SHAPES) == len(set(SHAPES)) == 52
