from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from engine.formats.characters import gltf, read
from tests.engine.formats.characters.scenes import JAW, document, glb

PLACES_OF_NAMES: dict[str, Callable[[dict[str, Any]], None]] = {
    "mesh": lambda mesh: mesh.update(extras={"targetNames": ["jawOpen", "mouthSmileLeft"]}),
    "primitive": lambda mesh: mesh["primitives"][0].update(extras={"targetNames": ["jawOpen", "mouthSmileLeft"]}),
    "target": lambda mesh: [
        target.update(extras={"name": name})
        for target, name in zip(mesh["primitives"][0]["targets"], ("jawOpen", "mouthSmileLeft"), strict=True)
    ],
    "too few in the mesh": lambda mesh: (
        mesh.update(extras={"targetNames": ["jawOpen"]}),
        mesh["primitives"][0].update(extras={"targetNames": ["other", "mouthSmileLeft"]}),
    ),
}


@pytest.mark.parametrize("place", PLACES_OF_NAMES)
@pytest.mark.parametrize("ending", ["glb", "vrm"])
def test_shapes_are_named_wherever_a_program_wrote_their_names(place: str, ending: str, tmp_path: Path) -> None:
    scene, binary = document()
    del scene["meshes"][0]["extras"]
    PLACES_OF_NAMES[place](scene["meshes"][0])
    raw = read(glb(tmp_path / f"a.{ending}", scene, binary))
    assert list(raw.shapes) == ["jawOpen", "mouthSmileLeft"]
    np.testing.assert_array_equal(raw.shapes["jawOpen"], JAW)


def test_shapes_are_named_by_their_accessors_where_nothing_else_names_them(tmp_path: Path) -> None:
    scene, binary = document()
    del scene["meshes"][0]["extras"]
    scene["accessors"][2]["name"] = "jawOpen"
    assert list(gltf.read(glb(tmp_path / "a.glb", scene, binary)).shapes) == ["jawOpen", "target 1"]


def test_two_shapes_of_one_name_are_both_kept(tmp_path: Path) -> None:
    scene, binary = document()
    scene["meshes"][0]["extras"]["targetNames"] = ["jawOpen", "jawOpen"]
    assert list(gltf.read(glb(tmp_path / "a.glb", scene, binary)).shapes) == ["jawOpen", "jawOpen #2"]
