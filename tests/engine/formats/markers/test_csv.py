from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.formats.markers import read


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
