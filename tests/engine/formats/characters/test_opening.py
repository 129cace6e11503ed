from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.character import bundled, save
from engine.errors import AssetError, FormatError
from engine.formats.characters.opening import character_of, is_own
from engine.formats.characters.reading import Reading
from engine.take import SHAPES
from tests.heads import write_glb


def kit(path: Path) -> Path:
    head = bundled()
    quads = np.concatenate([head.triangles, np.full((len(head.triangles), 1), -1, np.int32)], axis=1)
    np.savez(path, neutral=head.neutral, faces=quads, shape_names=np.array(SHAPES), deltas=head.deltas)
    return path


def test_a_head_of_ours_and_of_other_programs_opens(tmp_path: Path) -> None:
    save(bundled(), tmp_path / "own.NPZ")
    for path in (
        tmp_path / "own.NPZ",
        kit(tmp_path / "kit.npz"),
        write_glb(tmp_path / "a.glb", {n: n for n in SHAPES}),
    ):
        found = character_of(path)
        np.testing.assert_allclose(found.neutral, bundled().neutral, atol=1e-2)
    lying = character_of(tmp_path / "a.glb", Reading(facing_deg=90.0))
    assert np.abs(lying.neutral - bundled().neutral).max() > 20


def test_a_damaged_file_of_ours_is_told_apart_from_another_program_s(tmp_path: Path) -> None:
    save(bundled(), tmp_path / "own.npz")
    assert is_own(tmp_path / "own.npz") and not is_own(kit(tmp_path / "kit.npz"))
    assert not is_own(tmp_path / "nowhere.npz") and not is_own(tmp_path)
    (tmp_path / "own.txt").write_bytes((tmp_path / "own.npz").read_bytes())
    assert not is_own(tmp_path / "own.txt")
    (tmp_path / "own.npz").write_bytes(b"damaged")
    with pytest.raises(AssetError, match="missing or damaged"):
        character_of(tmp_path / "own.npz")
    np.savez(tmp_path / "kit.npz", **{**dict(np.load(tmp_path / "kit.npz")), "deltas": np.zeros((1, 2, 3))})
    with pytest.raises(FormatError, match="do not belong together"):
        character_of(tmp_path / "kit.npz")
