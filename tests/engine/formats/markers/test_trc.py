from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.markers.capture import Markers
from engine.formats.markers.trc import read, write


@pytest.mark.parametrize(
    ("unit", "mm"), [("Meters", 1000), ("millimeters", 1), ("inches", 25.4), ("CM", 10), ("metres", 1000)]
)
def test_units_of_a_trc_are_known_in_full_and_names_in_other_letters(tmp_path: Path, unit: str, mm: float) -> None:
    path = tmp_path / "m.trc"
    head = f"PathFileType\t4\t(X/Y/Z)\tm.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n60\t1\t1\t{unit}\n"
    path.write_text(f"{head}Frame#\tTime\tLèvre\n\t\tX1\tY1\tZ1\n1\t0\t1\t2\t3\n", "latin-1")
    found = read(path)
    assert found.names == ("Lèvre",)
    np.testing.assert_allclose(found.positions[0, 0], np.array([1, 2, 3]) * mm)


TRC = "PathFileType\t4\t(X/Y/Z)\tm.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n{}\nFrame#\tTime\ta\n\t\tX1\tY1\tZ1\n"


def places() -> Markers:
    positions = np.round(100 * np.random.default_rng(0).normal(size=(20, 3, 3)), 6)
    positions[3, 2] = positions[:4, 1] = np.nan
    return Markers(positions, ("nose", "lip upper", "Kinn"), 59.94)


def test_what_is_written_reads_back_equal(tmp_path: Path) -> None:
    write(places(), tmp_path / "a.trc")
    again = read(tmp_path / "a.trc")
    np.testing.assert_array_equal(again.positions, places().positions)
    assert (again.names, again.fps, again.name, again.notices) == (places().names, 59.94, "a.trc", ())
    rows = (tmp_path / "a.trc").read_text().splitlines()
    assert rows[0] == "PathFileType\t4\t(X/Y/Z)\ta.trc" and rows[2].split("\t")[1:5] == ["59.94", "20", "3", "mm"]
    assert rows[4].split("\t")[2:8] == ["X1", "Y1", "Z1", "X2", "Y2", "Z2"]
    assert rows[6].split("\t")[0] == "2" and float(rows[6].split("\t")[1]) == pytest.approx(1 / 59.94, abs=1e-9)


def test_what_is_asked_goes_before_what_the_file_says_and_the_origin_is_a_gap(tmp_path: Path) -> None:
    path = tmp_path / "a.trc"
    path.write_text(TRC.format("30\t2\t1\tcm") + "1\t0\t1\t2\t3\n2\t0\t0\t0\t0\n\n")
    found = read(path)
    np.testing.assert_array_equal(found.positions, [[[10, 20, 30]], [[np.nan] * 3]])
    assert found.fps == 30 and not found.notices
    found = read(path, unit="in", fps=50.0)
    np.testing.assert_allclose(found.positions[0, 0], [25.4, 50.8, 76.2])
    assert found.fps == 50.0
    path.write_text(TRC.format("30\t7\t1\tmm") + "1\t0\t1\t2\t0\n")
    found = read(path)
    assert found.notices == ("The file says it has 7 frames but holds 1.",) and found.positions[0, 0].tolist() == [
        1,
        2,
        0,
    ]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (TRC.format("30\t1\t1\tmm")[:40], "does not begin as a TRC"),
        (TRC.format("x\t1\t1\tmm") + "1\t0\t1\t2\t3\n", "does not say its datarate"),
        (TRC.format("30\t1"), "does not say its nummarkers"),
        (TRC.format("30\t1\t1\tmm") + "1\t0\t1\t2\tz\n", "'z' for a number in row 6, column 5"),
        (TRC.format("30\t1\tinf\tmm") + "1\t0\t1\t2\t3\n", "gives 'inf' for its nummarkers"),
    ],
)
def test_what_is_wrong_is_a_sentence(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "a.trc").write_text(text)
    with pytest.raises(FormatError, match=says):
        read(tmp_path / "a.trc")
