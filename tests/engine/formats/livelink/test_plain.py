from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.cli.performance import is_take
from engine.formats import livelink
from engine.formats.livelink.columns import DEFAULT_HEADER
from engine.formats.livelink.plain import NOTICE
from engine.take import SHAPES, Take

ROWS, LOST = 90, range(30, 40)


def app_rows() -> list[list[str]]:
    """Return a take as the app writes it, 90 rows at 60 fps, ten of them without a face."""
    rng = np.random.default_rng(5)
    motion = np.cumsum(rng.normal(0, 0.01, (ROWS, 61)), axis=0) + 0.4
    rows = [list(DEFAULT_HEADER)]
    for index, values in enumerate(motion):
        body = ["0"] if index in LOST else ["61", *(f"{value:.10f}" for value in values)]
        rows.append([f"10:00:{index // 60:02d}:{index % 60:02d}.250", *body])
    return rows


def padded(rows: list[list[str]]) -> list[list[str]]:
    return [row + [""] * (len(rows[0]) - len(row)) for row in rows]


def joined(rows: list[list[str]], separator: str = ",", end: str = "\n") -> str:
    return end.join(separator.join(row) for row in rows) + end


def quoted(rows: list[list[str]], **how: object) -> str:
    text = io.StringIO(newline="")
    csv.writer(text, quoting=csv.QUOTE_ALL, **how).writerows(rows)  # type: ignore[arg-type]
    return text.getvalue()


def german(rows: list[list[str]]) -> str:
    return joined([[cell.replace(".", ",") for cell in row] for row in padded(rows)], ";", "\r\n")


def indexed(rows: list[list[str]]) -> str:
    return joined([[str(place - 1) if place else "", *row] for place, row in enumerate(padded(rows))])


FORMS: dict[str, Callable[[list[list[str]]], bytes]] = {
    "Excel with semicolons": lambda rows: b"\xef\xbb\xbf" + joined(padded(rows), ";", "\r\n").encode(),
    "Excel with decimal commas": lambda rows: german(rows).encode(),
    "Excel's Unicode text": lambda rows: joined(padded(rows), "\t", "\r\n").encode("utf-16"),
    "R, with quotes": lambda rows: quoted(padded(rows)).encode(),
    "pandas, with its index": lambda rows: indexed(rows).encode(),
    "an old Mac": lambda rows: joined(rows, end="\r").encode(),
}


def read(tmp_path: Path, content: bytes) -> Take:
    path = tmp_path / "Größe.csv"
    path.write_bytes(content)
    return livelink.read(path)


@pytest.mark.parametrize("form", FORMS)
def test_a_take_saved_again_by_another_program_is_the_same_take(form: str, tmp_path: Path) -> None:
    rows = app_rows()
    expected = read(tmp_path, joined(rows).encode())
    take = read(tmp_path, FORMS[form](rows))
    np.testing.assert_array_equal(take.weights, expected.weights)
    np.testing.assert_array_equal(take.rotations, expected.rotations)
    np.testing.assert_array_equal(take.lost, expected.lost)
    assert (take.fps, take.start_s) == (expected.fps, expected.start_s)
    assert NOTICE in take.notices
    assert is_take(tmp_path / "Größe.csv")

    livelink.write(take, tmp_path / "out.csv")
    again = list(csv.reader(io.StringIO((tmp_path / "out.csv").read_text())))
    assert [[cell for cell in row if cell] for row in again] == rows


def test_what_the_app_writes_is_not_touched(tmp_path: Path) -> None:
    take = read(tmp_path, joined(app_rows()).encode())
    assert NOTICE not in take.notices


def test_columns_that_are_none_of_a_take_may_hold_anything(tmp_path: Path) -> None:
    rows = padded(app_rows())
    more = [["Note", "Unix", "", ""], *([f"take {row}", "1700000000.5", "", "-"] for row in range(ROWS))]
    content = joined([row + others for row, others in zip(rows, more, strict=True)]).encode()
    take = read(tmp_path, content)
    livelink.write(take, tmp_path / "out.csv")
    assert (tmp_path / "out.csv").read_bytes() == content
    changed = take.with_rows(50, take.weights[50:51] * 0.5)
    livelink.write(changed, tmp_path / "out.csv")
    lines, before = (tmp_path / "out.csv").read_bytes().splitlines(), content.splitlines()
    assert [place for place in range(len(lines)) if lines[place] != before[place]] == [51]
    assert lines[51].endswith(b",take 50,1700000000.5,,-")


@pytest.mark.parametrize(
    "spelt",
    [
        str.upper,
        lambda name: "".join(f"_{letter}" if letter.isupper() else letter for letter in name).strip("_"),
        lambda name: re.sub("Left$", "_L", re.sub("Right$", "_R", name)),
        lambda name: f" {name} ",
    ],
    ids=["upper", "snake", "sides", "blanks"],
)
def test_names_of_columns_are_known_however_they_are_spelt(spelt: Callable[[str], str], tmp_path: Path) -> None:
    rows = app_rows()
    expected = read(tmp_path, joined(rows).encode())
    rows[0] = [*rows[0][:2], *(spelt(name) for name in rows[0][2:])]
    take = read(tmp_path, joined(rows).encode())
    np.testing.assert_array_equal(take.weights, expected.weights)
    np.testing.assert_array_equal(take.rotations, expected.rotations)
    livelink.write(take, tmp_path / "named.csv", "named")
    cells = next(csv.reader(io.StringIO((tmp_path / "named.csv").read_text().splitlines()[1])))
    assert float(cells[DEFAULT_HEADER.index("MouthLeft")]) == take.weights[0, SHAPES.index("mouthLeft")]
