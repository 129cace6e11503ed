"""A character file that was damaged or made by hand is one sentence, never a head that cannot be drawn."""

from __future__ import annotations

import struct
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from engine.character import BUNDLED, Character, bundled, load, save, without_lacking
from engine.errors import AssetError, EditError, FormatError
from engine.formats.characters.opening import character_of
from engine.jaw import drawable
from engine.take import SHAPE_INDEX, SHAPES, Take

Stored = dict[str, Any]


def _with(name: str, change: Callable[[Any], Any]) -> Callable[[Stored], Stored]:
    return lambda stored: {**stored, name: change(stored[name])}


def _poked(value: float, dtype: type = np.float32) -> Callable[[Any], Any]:
    def poke(array: Any) -> Any:
        changed = array.astype(dtype)
        changed.flat[5] = value
        return changed

    return poke


DAMAGED = {
    "a vertex that is no number": _with("vertices", _poked(np.nan)),
    "a vertex at the end of the world": _with("vertices", _poked(1e30)),
    "a shape that is no number": _with("deltas", _poked(np.nan)),
    "a face with a vertex that is not there": _with("faces", _poked(10**8, np.int32)),
    "a face with a vertex below none": _with("faces", _poked(-5, np.int32)),
    "flat faces": _with("faces", np.ravel),
    "faces that are fractions": _with("faces", lambda faces: faces.astype(float)),
    "flat vertices": _with("vertices", np.ravel),
    "vertices that are words": _with("vertices", lambda vertices: vertices.astype(str)),
    "no vertices": _with("vertices", lambda vertices: vertices[:0]),
    "too few colours": _with("colours", lambda colours: colours[:5]),
    "a landmark that is not there": _with("landmark_vertices", _poked(10**8, np.int64)),
    "a landmark list that is a number": _with("landmark_vertices", lambda _: np.array(3)),
    "a mirror of another size": _with("mirror", lambda mirror: np.zeros(3, np.int32)),
    "a shape of no name": _with("shape_names", lambda names: np.array(["x"] * len(names))),
    "no faces at all": lambda stored: {name: array for name, array in stored.items() if name != "faces"},
}


@pytest.mark.parametrize("damage", DAMAGED.values(), ids=DAMAGED)
def test_a_damaged_character_is_a_sentence(tmp_path: Path, damage: Callable[[Stored], Stored]) -> None:
    with np.load(BUNDLED) as stored:
        np.savez(tmp_path / "head.npz", **damage(dict(stored)))
    for read in (load, character_of):
        with pytest.raises(AssetError, match=r"head\.npz is missing or damaged"):
            read(tmp_path / "head.npz")


def _npz_with_header(path: Path, name: str, dtype: str, shape: tuple[int, ...], like: Path) -> None:
    """Copy an npz but for one array, of which only a header is left that declares what no bytes fill."""
    header = f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}".ljust(117).encode() + b"\n"
    with zipfile.ZipFile(like) as old, zipfile.ZipFile(path, "w") as new:
        for member in old.namelist():
            empty = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header
            new.writestr(member, empty if member == f"{name}.npy" else old.read(member))


@pytest.mark.parametrize("dtype", ["<U0", "|S0", "|V0"])
@pytest.mark.parametrize("shape", [(10**9,), (10**18,), (10**9, 10**9)])
def test_values_without_width_are_not_counted_out(tmp_path: Path, dtype: str, shape: tuple[int, ...]) -> None:
    packed = tmp_path / "ict.npz"
    points = np.zeros((4, 3), np.float32)
    np.savez(packed, neutral=points, faces=np.zeros((2, 4), np.int32), shape_names=np.array(["a"]), deltas=points[None])
    _npz_with_header(tmp_path / "a.npz", "shape_names", dtype, shape, packed)
    with pytest.raises(FormatError, match="declares more data than it holds"):
        character_of(tmp_path / "a.npz")
    _npz_with_header(tmp_path / "b.npz", "landmark_names", dtype, shape, BUNDLED)
    with pytest.raises(AssetError, match="missing or damaged"):
        load(tmp_path / "b.npz")


def test_an_archive_that_unpacks_to_gigabytes_is_refused_unpacked(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        for name in ("neutral", "faces", "shape_names", "deltas"):
            with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                for _ in range(200 if name == "deltas" else 1):
                    file.write(bytes(4 << 20))
    assert (tmp_path / "a.npz").stat().st_size < 2e6
    with pytest.raises(FormatError, match="bytes of memory"):
        character_of(tmp_path / "a.npz")


@pytest.mark.parametrize("seed", range(6))
def test_flipped_bits_are_a_sentence_or_a_sound_head(tmp_path: Path, seed: int) -> None:
    content = bytearray(BUNDLED.read_bytes())
    rng = np.random.default_rng(seed)
    for at in rng.integers(len(content), size=40):
        content[at] ^= 1 << int(rng.integers(8))
    (tmp_path / "head.npz").write_bytes(content)
    with pytest.raises(AssetError, match="damaged"):
        load(tmp_path / "head.npz")


def test_a_sound_character_is_read_as_it_was_written(tmp_path: Path) -> None:
    save(bundled(), tmp_path / "head.npz")
    again = character_of(tmp_path / "head.npz")
    np.testing.assert_array_equal(again.triangles, bundled().triangles)
    assert again.landmarks == bundled().landmarks


def small(**change: Any) -> Character:
    """A head of four vertices; the jaw moves two of them, its mouthClose one."""
    rng = np.random.default_rng(0)
    deltas = np.zeros((len(SHAPES), 4, 3), np.float32)
    deltas[SHAPE_INDEX["jawOpen"], 1:3] = rng.integers(-8, 8, (2, 3))
    deltas[SHAPE_INDEX["mouthClose"], 2] = [1, 2, 3]
    whole = {
        "neutral": rng.integers(-50, 50, (4, 3)).astype(np.float32),
        "triangles": np.array([[0, 1, 2], [0, 2, 3]], np.int32),
        "deltas": deltas,
        "colours": np.full((4, 3), 7, np.uint8),
        "landmarks": {"chin": 3, "nose": 1},
        "name": "small",
    }
    return Character(**{**whole, **change})


def test_a_posed_head_is_its_rest_with_each_shape_s_share_added() -> None:
    head = small()
    weights = np.zeros(len(SHAPES))
    weights[SHAPE_INDEX["jawOpen"]], weights[SHAPE_INDEX["mouthClose"]] = 0.5, 0.25
    expected = head.neutral + np.tensordot(weights, head.deltas, 1)
    np.testing.assert_allclose(head.vertices(weights), expected)
    np.testing.assert_allclose(head.vertices(weights + np.where(weights > 0, 0, -3.0)), expected)
    weights[SHAPE_INDEX["mouthClose"]] = 0.9  # closes no further than the jaw has opened
    np.testing.assert_allclose(
        head.vertices(weights), head.neutral + np.tensordot(np.minimum(weights, 0.5), head.deltas, 1)
    )
    weights[SHAPE_INDEX["jawOpen"]] = 7.0
    assert drawable(weights.astype(np.float32))[SHAPE_INDEX["jawOpen"]] == 1.0
    np.testing.assert_array_equal(head.vertices(np.zeros(len(SHAPES))), head.neutral)


def test_what_a_head_lacks_is_taken_out_of_a_take_and_said() -> None:
    head = small()
    assert set(head.lacking) == set(SHAPES) - {"jawOpen", "mouthClose"}
    weights = np.zeros((3, len(SHAPES)))
    weights[1, SHAPE_INDEX["jawOpen"]] = 0.5
    take = Take(weights, 30.0, notices=("before",))
    assert without_lacking(take, head) is take
    for count, named in ((2, "eyeBlinkLeft, eyeLookDownLeft:"), (6, "eyeLookInLeft, eyeLookOutLeft and 2 more:")):
        more = weights.copy()
        more[2, :count] = 0.021
        found = without_lacking(replace(take, weights=more), head)
        np.testing.assert_array_equal(found.weights, weights)
        assert found.notices[0] == "before" and named in found.notices[1] and "small has no" in found.notices[1]
    more = weights.copy()
    more[2, 0] = 0.02  # not worth a word
    found = without_lacking(replace(take, weights=more), head)
    assert found.notices == ("before",) and not found.weights[2].any()


def test_a_split_head_knows_its_file_s_vertices() -> None:
    split, corners = np.array([2, 0, 0, 1, 3], np.int32), np.array([[0, 1, 3], [4, 2, 0]], np.int32)
    head, whole = small(split=split, split_triangles=corners), small()
    assert [head.vertex_of(number) for number in range(5)] == [2, 0, 0, 1, 3]
    assert [head.number_of(vertex) for vertex in range(4)] == [1, 3, 0, 4]
    assert head.triangles_in_file is corners and whole.triangles_in_file is whole.triangles
    np.testing.assert_array_equal(head.as_in_file(head.neutral), head.neutral[split])
    assert whole.as_in_file(whole.neutral) is whole.neutral and whole.vertex_of(3) == 3 and whole.number_of(2) == 2
    for character, count in ((head, 5), (whole, 4)):
        for number in (-1, count):
            with pytest.raises(EditError, match=f"small has no vertex {number}. It has {count}"):
                character.vertex_of(number)


def test_landmarks_are_given_at_rest_and_for_each_shape() -> None:
    head = small()
    rest, deltas = head.landmark_positions(["nose", "chin"])
    np.testing.assert_array_equal(rest, head.neutral[[1, 3]])
    np.testing.assert_array_equal(deltas, head.deltas[:, [1, 3]])
    with pytest.raises(AssetError, match="no landmark 'ear'"):
        head.landmark_positions(["chin", "ear"])


def test_what_is_saved_is_read_back_to_a_half_float(tmp_path: Path) -> None:
    split = {"split": np.array([0, 1, 2, 3, 0], np.int32), "split_triangles": np.array([[4, 1, 2]], np.int32)}
    for head in (small(), small(**split), small(mirror=np.array([1, 0, 3, 2], np.int32), name="x" * 90)):
        save(head, tmp_path / "a.npz")
        again = load(tmp_path / "a.npz")
        for name in ("neutral", "triangles", "colours", "mirror", "split", "split_triangles", "deltas"):
            np.testing.assert_array_equal(getattr(again, name), getattr(head, name))
        assert again.landmarks == head.landmarks and again.name == head.name[:80]


@pytest.mark.parametrize(
    "change",
    [
        {"split": np.array([0, 1], np.int32), "split_triangles": np.array([[0, 1, 2]], np.int32)},
        {"split": np.array([0, 1, 4], np.int32), "split_triangles": np.array([[0, 1, 2]], np.int32)},
        {"split": np.array([0, 1, 2], np.int32), "split_triangles": np.array([[0, 1, -1]], np.int32)},
        {"split": np.array([0, 1, 2], np.int32)},
        {"split": np.array([[0, 1, 2]], np.int32), "split_triangles": np.array([[0, 0, 0]], np.int32)},
        {"neutral": np.full((4, 3), 1e6, np.float32)},
        {"neutral": np.full((4, 3), -1e6, np.float32)},
        {"triangles": np.zeros((0, 3), np.int32)},
        {"mirror": np.zeros(3, np.int32)},
        {"landmarks": {"chin": 4}},
        {"landmarks": {"chin": -1}},
        {"colours": np.zeros((3, 3), np.uint8)},
    ],
    ids=str,
)
def test_a_head_whose_parts_do_not_belong_together_is_refused(tmp_path: Path, change: dict[str, Any]) -> None:
    save(small(**change), tmp_path / "a.npz")
    with pytest.raises(AssetError, match=r"a\.npz is missing or damaged"):
        load(tmp_path / "a.npz")
