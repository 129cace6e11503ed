from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.markers import read
from tests.c3d import DEC, INTEL, c3d

NAMES = ("nose", "lip upper", "Kinn ä".encode().decode("latin-1"), "M5")


@pytest.fixture
def positions() -> np.ndarray:
    positions = np.round(100 * np.random.default_rng(0).normal(size=(30, 4, 3)), 1) + 500.0
    positions[3, 2] = positions[:4, 3] = np.nan
    return positions


@pytest.mark.parametrize("processor", [INTEL, DEC], ids=["intel", "dec"])
@pytest.mark.parametrize("scale", [-1.0, 0.1, -0.05], ids=["floats", "whole numbers", "floats of a scale"])
def test_points_are_read_in_each_form(tmp_path: Path, positions: np.ndarray, processor: int, scale: float) -> None:
    path = tmp_path / "m.c3d"
    path.write_bytes(c3d(positions, NAMES, processor=processor, scale=scale, rate=120.0))
    found = read(path)
    np.testing.assert_allclose(found.positions, positions, atol=1e-3)
    assert found.names[:2] == NAMES[:2] and len(found.names) == 4 and found.fps == 120.0


def test_units_are_honoured_and_long_takes_count_their_frames_elsewhere(tmp_path: Path, positions: np.ndarray) -> None:
    path = tmp_path / "m.c3d"
    path.write_bytes(c3d(positions / 1000, NAMES, unit="m", long_frames=30))
    np.testing.assert_allclose(read(path).positions, positions, atol=1e-3)


def test_the_reader_agrees_with_another(tmp_path: Path, positions: np.ndarray) -> None:
    ezc3d = pytest.importorskip("ezc3d")
    path = tmp_path / "m.c3d"
    path.write_bytes(c3d(positions, NAMES))
    other = ezc3d.c3d(str(path))
    found = read(path).positions
    seen = np.isfinite(found).all(axis=2)
    np.testing.assert_array_equal(other["data"]["points"][:3].transpose(2, 1, 0)[seen], found[seen])
    assert [name.strip() for name in other["parameters"]["POINT"]["LABELS"]["value"]][:2] == list(NAMES[:2])


def test_what_is_cut_off_anywhere_is_a_sentence(tmp_path: Path, positions: np.ndarray) -> None:
    whole, path = c3d(positions, NAMES), tmp_path / "m.c3d"
    for length in range(0, len(whole) - 512, 37):
        path.write_bytes(whole[:length])
        with pytest.raises(FormatError, match=r"m\.c3d"):
            read(path)


@pytest.mark.parametrize("at", [0, 2, 6, 8, 16])
def test_header_words_that_cannot_be_are_a_sentence(tmp_path: Path, positions: np.ndarray, at: int) -> None:
    content = bytearray(c3d(positions, NAMES))
    content[at : at + 2] = b"\xff\x50" if at == 0 else b"\xff\xff"
    path = tmp_path / "m.c3d"
    path.write_bytes(content)
    with pytest.raises(FormatError, match=r"m\.c3d"):
        read(path)
