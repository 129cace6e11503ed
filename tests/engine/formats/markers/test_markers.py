from __future__ import annotations

import struct
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from engine.errors import FormatError
from engine.formats.markers import read, write
from engine.formats.markers.capture import Markers


@pytest.fixture
def markers() -> Markers:
    rng = np.random.default_rng(0)
    positions = np.round(100 * rng.normal(size=(20, 5, 3)), 6)
    positions[3, 2] = positions[:4, 4] = np.nan
    return Markers(positions, ("nose", "lip upper", "x", "brow_left", "M5"), 59.94)


@pytest.mark.parametrize("ending", ["csv", "trc"])
def test_what_is_written_reads_back_equal(markers: Markers, tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"capture.{ending}"
    write(markers, path)
    again = read(path)
    np.testing.assert_array_equal(again.positions, markers.positions)
    assert again.names == markers.names
    assert again.fps == pytest.approx(59.94, abs=1e-3)
    assert again.notices == ()


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


def exported(kind: str) -> str:
    """Return two markers over ninety frames at 50 fps, in metres or mm, with the headings of a capture system."""
    names, frames = ["Chin", "Nose"], np.arange(90)
    unit = 0.001 if kind == "motive" else 1.0
    numbers = [[f"{(row + 60 * place) * unit:.4f}" for place in range(6)] for row in frames]
    times = [[str(row), f"{row / 50:.5f}"] for row in frames]
    heads: dict[str, list[list[str]]] = {
        "vicon": [["Trajectories"], ["50"], ["", "", "Chin", "", "", "Nose"], ["Frame", "Sub Frame", *"XYZXYZ"]],
        "motive": [
            [
                *[
                    "Format Version",
                    "1.23",
                    "Capture Frame Rate",
                    "100",
                    "Export Frame Rate",
                    "50",
                    "Length Units",
                    "Meters",
                ]
            ],
            [],
            ["", "Type", *["Rigid Body"] * 3, *["Marker"] * 6],
            ["", "Name", *["Cap"] * 3, *np.repeat(names, 3)],
            ["", "ID", *["7"] * 3, *["A3:1"] * 3, *["A3:2"] * 3],
            ["", "", *["Rotation"] * 3, *["Position"] * 6],
            ["Frame", "Time (Seconds)", *"XYZ" * 3],
        ],
        "qualisys": [["NO_OF_FRAMES", "90"], ["NO_OF_MARKERS", "2"], ["FREQUENCY", "50"], ["MARKER_NAMES", *names]],
    }
    body = numbers if kind == "qualisys" else [time + row for time, row in zip(times, numbers, strict=True)]
    if kind == "motive":
        body = [[*row[:2], "0", "0", "0", *row[2:]] for row in body]
    if kind == "vicon":
        body = [["", "", *["mm"] * 6], *([row[0], "0", *row[2:]] for row in body)]
    mark = "\t" if kind == "qualisys" else ","
    return "\r\n".join(mark.join(row) for row in [*heads[kind], *body]) + "\r\n"


@pytest.mark.parametrize(("kind", "ending"), [("vicon", ".csv"), ("motive", ".csv"), ("qualisys", ".tsv")])
def test_exports_of_capture_systems_are_read_as_they_come(tmp_path: Path, kind: str, ending: str) -> None:
    path = tmp_path / f"m{ending}"
    path.write_text(exported(kind), newline="")
    found = read(path)
    assert (found.names, found.fps, len(found)) == (("Chin", "Nose"), 50.0, 90)
    np.testing.assert_allclose(found.positions[2], [[2, 62, 122], [182, 242, 302]], atol=1e-9)
    assert found.notices == ()


CSV = "time,a_x,a_y,a_z\n"
TRC = "PathFileType\t4\t(X/Y/Z)\tm.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n{}\nFrame#\tTime\ta\n\t\tX1\tY1\tZ1\n"


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("m.csv", "", "empty"),
        ("m.csv", "\x89PNG\x00\x01", "not a text file"),
        ("m.csv", "hello\nworld\n", "no columns of markers"),
        ("m.csv", CSV, "no frames"),
        ("m.csv", "time,a_x,a_y\n0,1,2\n", "no z column for the marker 'a'"),
        ("m.csv", "a_x,a_y,a_z,a_x\n0,1,2,3\n", "twice"),
        ("m.csv", CSV + "0,1,2,3\n0,1,oops,3\n", "'oops' for a number in row 3, column 3"),
        ("m.csv", CSV + "0,1,2,3,4\n", "5 cells in row 2"),
        ("m.csv", CSV + "0,1,inf,3\n", "infinite number in row 2, column 3"),
        ("m.csv", CSV + "0,,,\n", "no frame in which a marker was seen"),
        ("m.csv", ",".join(f"a{index}_x" for index in range(20000)), "too many columns"),
        ("m.trc", "hello\n" * 8, "does not begin as a TRC"),
        ("m.trc", TRC.format("30\t1\t2\tmm") + "1\t0\t1\t2\t3\n", "says it has 2 markers but names 1"),
        ("m.trc", TRC.format("30\t1\t1\tfurlong") + "1\t0\t1\t2\t3\n", "unit 'furlong'"),
        ("m.trc", TRC.format("nan\t1\t1\tmm") + "1\t0\t1\t2\t3\n", "'nan' for its datarate"),
        ("m.trc", TRC.format("30\t1\t1\tmm"), "no frames"),
        ("m.trc", TRC.format("-3\t1\t1\tmm") + "1\t0\t1\t2\t3\n", "frame rate above zero"),
        ("m.xyz", "?", "not a kind of file"),
    ],
)
def test_bad_files_get_one_plain_sentence(tmp_path: Path, name: str, text: str, says: str) -> None:
    path = tmp_path / name
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(FormatError, match=says):
        read(path)


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(body=st.binary(max_size=300), kind=st.sampled_from(["csv", "trc", "c3d"]), headed=st.booleans())
def test_any_bytes_are_read_or_refused(tmp_path: Path, body: bytes, kind: str, headed: bool) -> None:
    head = {"csv": CSV, "trc": TRC.format("30\t1\t1\tmm"), "c3d": "\x02P"}[kind]
    path = tmp_path / f"m.{kind}"
    path.write_bytes(head.encode("latin-1") * headed + body)
    try:
        assert len(read(path).names) >= 1
    except FormatError as error:
        assert str(error)


def test_a_c3d_that_declares_too_much_is_refused_before_it_is_parsed(tmp_path: Path) -> None:
    path = tmp_path / "m.c3d"
    content = bytearray(_c3d(path, [["a", "b", "c"]], 3).read_bytes())
    content[2:10] = struct.pack("<HHHH", 600, 0, 1, 6000)
    path.write_bytes(content)
    with pytest.raises(FormatError, match="declares more points than it holds"):
        read(path)
    content[2:10] = struct.pack("<HHHH", 60000, 0, 1, 65535)
    path.write_bytes(content)
    with pytest.raises(FormatError, match="asks for"):
        read(path)


def test_c3d_points_arrive_with_their_gaps(markers: Markers, tmp_path: Path) -> None:
    ezc3d = pytest.importorskip("ezc3d")
    content = ezc3d.c3d()
    content["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    content["parameters"]["POINT"]["UNITS"]["value"] = ["m"]
    content["parameters"]["POINT"]["LABELS"]["value"] = list(markers.names)
    points = np.ones((4, 5, 20))
    points[:3] = markers.positions.transpose(2, 1, 0) / 1000
    content["data"]["points"] = points
    path = tmp_path / "m.c3d"
    content.write(str(path))
    again = read(path)
    np.testing.assert_allclose(again.positions, markers.positions, atol=1e-3)
    assert again.names == markers.names and again.fps == 100.0


def _c3d(path: Path, labels: list[list[str]], points: int, frames: int = 3) -> Path:
    ezc3d = pytest.importorskip("ezc3d")
    content = ezc3d.c3d()
    content["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    content["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    content["parameters"]["POINT"]["LABELS"]["value"] = [name for part in labels for name in part]
    content["data"]["points"] = np.arange(4.0 * points * frames).reshape(4, points, frames) + 1
    content.write(str(path))
    return path


@pytest.mark.parametrize("count", [255, 256, 260, 600])
def test_a_c3d_names_more_points_than_one_list_holds(count: int, tmp_path: Path) -> None:
    names = [f"F{number:03}" for number in range(count)]
    found = read(_c3d(tmp_path / "m.c3d", [names], count))
    assert found.names == tuple(names) and found.notices == ()


def test_points_of_one_name_or_of_none_are_numbered_and_said(tmp_path: Path) -> None:
    found = read(_c3d(tmp_path / "m.c3d", [["lip", "lip", "lip 2", "", "lip"]], 5))
    assert len(set(found.names)) == 5 and found.names[:3] == ("lip", "lip 3", "lip 2") and found.names[3] == "marker 4"
    assert any("got a number" in notice for notice in found.notices)


@pytest.mark.parametrize("ending", ["trc", "csv"])
def test_markers_of_one_name_are_numbered_in_text_files_too(ending: str, markers: Markers, tmp_path: Path) -> None:
    path = tmp_path / f"m.{ending}"
    write(markers, path)
    path.write_text(path.read_text().replace("brow_left", "nose"))
    found = read(path)
    assert found.names == ("nose", "lip upper", "x", "nose 2", "M5")
    np.testing.assert_array_equal(found.positions[:, 3], markers.positions[:, 3])
    assert "got a number: nose" in found.notices[0]


def test_the_byte_order_of_sgi_machines_is_named(tmp_path: Path) -> None:
    path = _c3d(tmp_path / "m.c3d", [["a", "b", "c"]], 3)
    content = bytearray(path.read_bytes())
    content[(content[0] - 1) * 512 + 3] = 86
    path.write_bytes(content)
    with pytest.raises(FormatError, match="byte order of SGI"):
        read(path)


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
