from __future__ import annotations

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


@pytest.mark.parametrize("ending", ["trc", "csv"])
def test_markers_of_one_name_are_numbered_in_text_files_too(ending: str, markers: Markers, tmp_path: Path) -> None:
    path = tmp_path / f"m.{ending}"
    write(markers, path)
    path.write_text(path.read_text().replace("brow_left", "nose"))
    found = read(path)
    assert found.names == ("nose", "lip upper", "x", "nose 2", "M5")
    np.testing.assert_array_equal(found.positions[:, 3], markers.positions[:, 3])
    assert "got a number: nose" in found.notices[0]
