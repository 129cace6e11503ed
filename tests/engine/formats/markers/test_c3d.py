from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.markers import read
from engine.formats.markers.capture import Markers


@pytest.fixture
def markers() -> Markers:
    rng = np.random.default_rng(0)
    positions = np.round(100 * rng.normal(size=(20, 5, 3)), 6)
    positions[3, 2] = positions[:4, 4] = np.nan
    return Markers(positions, ("nose", "lip upper", "x", "brow_left", "M5"), 59.94)


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


def test_the_byte_order_of_sgi_machines_is_named(tmp_path: Path) -> None:
    path = _c3d(tmp_path / "m.c3d", [["a", "b", "c"]], 3)
    content = bytearray(path.read_bytes())
    content[(content[0] - 1) * 512 + 3] = 86
    path.write_bytes(content)
    with pytest.raises(FormatError, match="byte order of SGI"):
        read(path)
