from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.markers.capture import Markers
from engine.formats.markers.csv import read, write


def test_units_are_guessed_from_the_size_and_said(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text("frame;a.X;a.Y;a.Z;b.X;b.Y;b.Z\n0;0;0;0;0.1;0.2;0\n1;0;0;0;;;\n")
    found = read(path)
    np.testing.assert_allclose(found.positions[0, 1], [100, 200, 0])
    assert np.isnan(found.positions[1, 1]).all()
    assert "taken as m" in found.notices[0] and "30 fps" in found.notices[1]
    np.testing.assert_allclose(read(path, unit="cm", fps=50.0).positions[0, 1], [1, 2, 0])


def table(head: str, *, fps: float = 30.0, separator: str = ",", time: str = "{:.4f}") -> str:
    names = [head.format(name, axis) for name in ("Nose", "Left") for axis in "XYZ"]
    rows = [
        [str(row), time.format(row / fps), *("%.3f" % (row + 60 * place) for place in range(6))] for row in range(120)
    ]
    return "\n".join(separator.join(cells) for cells in [["Frame", "Time (Seconds)", *names], *rows]) + "\n"


@pytest.mark.parametrize("head", ["{}_{}", "{}.{}", "{} ({})", "{}:{}", "{}.t{}", "{}_pos{}", "{} Position {}", "{}{}"])
def test_columns_are_named_as_other_programs_do(tmp_path: Path, head: str) -> None:
    path = tmp_path / "m.csv"
    path.write_text(table(head))
    found = read(path)
    assert found.names == ("Nose", "Left") and found.fps == 30
    assert found.positions[2].tolist() == [[2, 62, 122], [182, 242, 302]]


@pytest.mark.parametrize("fps", [24, 25, 24_000 / 1001, 30_000 / 1001, 30, 59.94005994, 60, 100, 120])
def test_rounded_times_tell_the_rate(tmp_path: Path, fps: float) -> None:
    path = tmp_path / "m.csv"
    path.write_text(table("{}_{}", fps=fps))
    assert read(path).fps == pytest.approx(fps, rel=1e-8)
    path.write_text(table("{}_{}", fps=fps / 1000, time="{:.1f}").replace("(Seconds)", "(ms)"))
    assert read(path).fps == pytest.approx(fps, rel=1e-8)


def test_times_that_go_on_in_two_paces_tell_the_one_between(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text("time,a_x,a_y,a_z\n0,1,2,3\n0.1,1,2,3\n1.1,1,2,3\n")
    assert read(path).fps == pytest.approx(1 / 0.55, abs=1e-6)


def test_a_spreadsheet_s_quotes_and_decimal_commas_are_read(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text(table("{}_{}"))
    expected = read(path)
    path.write_text(table("{}_{}", separator=";").replace(".", ","))
    np.testing.assert_array_equal(read(path).positions, expected.positions)
    path.write_text("\n".join('"' + line.replace(",", '","') + '"' for line in table("{}_{}").splitlines()))
    np.testing.assert_array_equal(read(path).positions, expected.positions)
    assert read(path).fps == expected.fps == 30


def test_what_is_written_reads_back_equal_with_its_gaps(tmp_path: Path) -> None:
    positions = np.round(100 * np.random.default_rng(0).normal(size=(20, 2, 3)), 6)
    positions[3, 1] = np.nan
    write(Markers(positions, ("nose", "lip upper"), 50.0), tmp_path / "a.csv")
    again = read(tmp_path / "a.csv")
    np.testing.assert_array_equal(again.positions, positions)
    assert (again.names, again.fps, again.notices) == (("nose", "lip upper"), 50.0, ())
    rows = (tmp_path / "a.csv").read_text().splitlines()
    assert rows[0] == ",".join(["time", *(f"{name}_{axis} (mm)" for name in again.names for axis in "xyz")])
    assert rows[2].startswith("0.020000000,") and rows[4].endswith(",,,")


def seen(tmp_path: Path, head: str, *rows: str, **asked: object) -> Markers:
    (tmp_path / "a.csv").write_text("\n".join([head, *rows]))
    return read(tmp_path / "a.csv", **asked)


def test_a_marker_of_which_a_coordinate_lacks_is_a_gap(tmp_path: Path) -> None:
    found = seen(tmp_path, "a_x (cm),a_y (cm),a_z (cm)", "1,2,3", "1,,3", fps=10.0)
    np.testing.assert_array_equal(found.positions, [[[10, 20, 30]], [[np.nan] * 3]])
    assert found.fps == 10.0 and not found.notices


def test_markers_of_one_name_are_two_where_each_is_whole(tmp_path: Path) -> None:
    found = seen(tmp_path, "a_x,a_y,a_z,b_x,b_y,b_z,a_x,a_y,a_z", "1,2,3,400,500,600,7,8,9", unit="mm", fps=10.0)
    assert found.names == ("a", "b", "a 2") and found.positions[0].tolist() == [[1, 2, 3], [400, 500, 600], [7, 8, 9]]


@pytest.mark.parametrize(
    ("head", "says"),
    [
        ("a_x,a_y,a_y,a_z", "names the column 'a_y' twice"),
        ("a_x,a_z", "no y column for the marker 'a'"),
        ("a_x,a_y,a_z,a_x,a_y", "names columns of the marker 'a' twice"),
        ("a_x (mm),a_y (mm),a_z (cm)", "different units"),
        ("time,frame,index", "no columns of markers"),
    ],
)
def test_columns_that_make_no_markers_are_a_sentence(tmp_path: Path, head: str, says: str) -> None:
    with pytest.raises(FormatError, match=says):
        seen(tmp_path, head, ",".join("1" * (head.count(",") + 1)))


@pytest.mark.parametrize(
    ("times", "fps"),
    [
        ([0.0, 0.04, 0.08, 0.2, 0.24], 25.0),
        ([5.0, 5.01, 5.02], 100.0),
        ([0.0, 1 / 37, 2 / 37, 3 / 37], 37.0),
        ([0.0, 20.0, 40.0], None),
        ([0.0, 0.0, 0.0], None),
        ([0.0], None),
    ],
)
def test_the_rate_is_that_of_the_usual_step_or_none_is_told(
    tmp_path: Path, times: list[float], fps: float | None
) -> None:
    found = seen(tmp_path, "time,a_x,a_y,a_z", *(f"{time},100,200,300" for time in times), unit="mm")
    assert found.fps == pytest.approx(fps or 30.0, abs=0.01) and bool(found.notices) == (fps is None)
