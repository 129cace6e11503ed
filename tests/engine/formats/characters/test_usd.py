from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import EngineError
from engine.formats.characters import usd
from engine.formats.characters.moving import MovingMesh

REST = np.array([[0.0, 0, 0], [100, 0, 0], [0, 50, 0], [0, 0, 25]])
MESH = MovingMesh(
    REST, np.array([[0, 1, 2], [0, 2, 3]]), np.stack([REST, REST + 10, REST * 2]).astype(np.float32), 24.0
)


@pytest.mark.parametrize("ending", usd.ENDINGS)
def test_a_mesh_is_written_in_metres_with_a_sample_and_an_extent_at_each_frame(tmp_path: Path, ending: str) -> None:
    Usd, UsdGeom = pytest.importorskip("pxr.Usd"), pytest.importorskip("pxr.UsdGeom")
    path = tmp_path / f"a{ending.upper()}"
    usd.write(MESH, path)
    path.rename(tmp_path / f"b{ending}")
    stage = Usd.Stage.Open(str(tmp_path / f"b{ending}"))
    shown = UsdGeom.Mesh(stage.GetDefaultPrim())
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode(), stage.GetFramesPerSecond()) == (0, 2, 24.0)
    assert UsdGeom.GetStageUpAxis(stage) == "Y" and UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert list(shown.GetFaceVertexCountsAttr().Get()) == [3, 3]
    assert list(shown.GetFaceVertexIndicesAttr().Get()) == [0, 1, 2, 0, 2, 3]
    for frame, vertices in enumerate(MESH.frames):
        np.testing.assert_allclose(np.array(shown.GetPointsAttr().Get(frame)), vertices / 1000, atol=1e-7)
        low, high = np.array(shown.GetExtentAttr().Get(frame))
        np.testing.assert_allclose((low, high), (vertices.min(axis=0) / 1000, vertices.max(axis=0) / 1000), atol=1e-7)


def test_without_its_package_nothing_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pxr", None)
    with pytest.raises(EngineError, match="needs the package usd-core"):
        usd.write(MESH, tmp_path / "a.usda")
    assert not list(tmp_path.iterdir())
