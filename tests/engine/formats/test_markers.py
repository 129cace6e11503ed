from __future__ import annotations

import struct
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from engine.errors import FormatError
from engine.formats.capture import Markers
from engine.formats.markers import read, write


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


def test_c3d_without_its_reader_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ezc3d", None)
    path = tmp_path / "m.c3d"
    path.write_bytes(b"\x02\x50" + bytes(600))
    with pytest.raises(FormatError, match=r"not installed.*retake\[c3d\]"):
        read(path)


def test_a_c3d_that_declares_too_much_is_refused_before_it_is_parsed(tmp_path: Path) -> None:
    path = tmp_path / "m.c3d"
    path.write_bytes(b"\x02\x50" + struct.pack("<HHHH", 60000, 0, 1, 65535) + bytes(600))
    with pytest.raises(FormatError, match="declares more points than it holds"):
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
