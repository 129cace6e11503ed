"""A character file that was damaged or made by hand is one sentence, never a head that cannot be drawn."""

from __future__ import annotations

import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from engine.character import BUNDLED, bundled, load, save
from engine.errors import AssetError, FormatError
from engine.formats.characters.opening import character_of

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
