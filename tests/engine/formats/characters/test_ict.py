from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.characters import ict
from engine.formats.characters.raw import MAX_SHAPES

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.5]], np.float32)
PACKED = {
    "neutral": POINTS,
    "faces": np.array([[0, 1, 2, 3], [0, 2, 3, -1]], np.int32),
    "shape_names": np.array(["jawOpen", "eyeBlink_L"]),
    "deltas": np.stack([POINTS * 0.1, -POINTS]),
}


def packed(path: Path, **change: np.ndarray) -> Path:
    np.savez(path, **{**PACKED, **change})
    return path


def test_a_packed_facekit_is_read_with_its_quads_cut_in_two(tmp_path: Path) -> None:
    raw = ict.read(packed(tmp_path / "kit.npz"))
    assert raw.name == "kit" and list(raw.shapes) == ["jawOpen", "eyeBlink_L"]
    np.testing.assert_array_equal(raw.vertices, POINTS)
    np.testing.assert_array_equal(raw.triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 3]])
    np.testing.assert_array_equal(raw.shapes["eyeBlink_L"], -POINTS)
    assert raw.triangles.dtype == np.int32
    np.testing.assert_array_equal(ict.triangulated(np.array([[3, 1, 2]], np.int64)), [[3, 1, 2]])
    np.testing.assert_array_equal(ict.triangulated(np.array([[5, 1, 2, 0]])), [[5, 1, 2], [5, 2, 0]])


def test_it_is_known_by_its_arrays(tmp_path: Path) -> None:
    assert ict.is_ict(packed(tmp_path / "a.npz", more=POINTS))
    np.savez(tmp_path / "b.npz", **{name: PACKED[name] for name in ("neutral", "faces", "deltas")})
    assert not ict.is_ict(tmp_path / "b.npz")


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"neutral": POINTS[:, :2]}, "do not belong together"),
        ({"neutral": POINTS.ravel()}, "do not belong together"),
        ({"faces": PACKED["faces"][:, :2]}, "do not belong together"),
        ({"faces": PACKED["faces"].ravel()}, "do not belong together"),
        ({"faces": PACKED["faces"].astype(float)}, "do not belong together"),
        ({"deltas": PACKED["deltas"][:1]}, "do not belong together"),
        ({"deltas": PACKED["deltas"][:, :3]}, "do not belong together"),
        ({"neutral": np.array([["a"] * 3] * 4)}, "damaged or not an ICT-FaceKit"),
        ({"shape_names": np.array(["x"] * (MAX_SHAPES + 1))}, "more data than a character can hold"),
        ({"faces": np.array([[0, 1, 2, 9]])}, "names vertex 9"),
    ],
)
def test_what_is_wrong_is_a_sentence(tmp_path: Path, change: dict[str, np.ndarray], says: str) -> None:
    with pytest.raises(FormatError, match=says):
        ict.read(packed(tmp_path / "kit.npz", **change))


def test_as_many_shapes_as_there_may_be_are_read(tmp_path: Path) -> None:
    names = np.array([f"x{number}" for number in range(MAX_SHAPES)])
    raw = ict.read(packed(tmp_path / "kit.npz", shape_names=names, deltas=np.zeros((MAX_SHAPES, 4, 3), np.float32)))
    assert len(raw.shapes) == MAX_SHAPES
