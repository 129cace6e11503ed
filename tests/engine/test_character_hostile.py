"""A character file that was damaged or made by hand is one sentence, never a head that cannot be drawn."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from engine.character import BUNDLED, bundled, load, save
from engine.errors import AssetError
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
