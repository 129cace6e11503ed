from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from engine.character import bundled
from engine.errors import EngineError, FormatError
from engine.formats import read_take
from engine.formats.characters import gltf
from engine.formats.characters.animation import TOLERANCE, targets, write
from engine.formats.characters.moving import MovingMesh
from engine.lab.performer import demo


def moving() -> MovingMesh:
    head = bundled()
    weights = read_take(demo.BUNDLED).weights[60:100]
    frames = np.stack([head.vertices(frame) for frame in weights])
    return MovingMesh(head.neutral.astype(float), head.triangles, frames, 30.0)


def test_targets_times_weights_give_every_frame() -> None:
    mesh = moving()
    shapes, weights = targets(mesh)
    played = mesh.rest + np.tensordot(weights, shapes, 1)
    size = np.linalg.norm(np.ptp(mesh.rest, axis=0))
    assert np.abs(played - mesh.frames).max() <= 1.01 * TOLERANCE * size
    assert 0 < len(shapes) < len(mesh.frames) and np.abs(weights).max() <= 1 + 1e-6


def test_a_glb_reads_back_with_its_targets_in_metres(tmp_path: Path) -> None:
    mesh = moving()
    write(mesh, tmp_path / "out.glb")
    raw = gltf.read(tmp_path / "out.glb")
    np.testing.assert_allclose(raw.vertices * 1000, mesh.rest, atol=1e-3)
    shapes, _ = targets(mesh)
    np.testing.assert_allclose(np.stack(list(raw.shapes.values())) * 1000, shapes, atol=1e-3)


def test_a_still_mesh_has_no_targets_and_no_animation(tmp_path: Path) -> None:
    mesh = moving()
    still = MovingMesh(mesh.frames[0].astype(float), mesh.triangles, mesh.frames[:1].repeat(3, axis=0), 30.0)
    write(still, tmp_path / "still.glb")
    assert not gltf.read(tmp_path / "still.glb").shapes
    assert b"animations" not in (tmp_path / "still.glb").read_bytes()


@pytest.mark.parametrize("ending", [".usd", ".usdc", ".usda"])
def test_usd_plays_every_frame_in_metres(ending: str, tmp_path: Path) -> None:
    usd, geometry = pytest.importorskip("pxr.Usd"), pytest.importorskip("pxr.UsdGeom")
    mesh = moving()
    write(mesh, tmp_path / f"out{ending}")
    stage = usd.Stage.Open(str(tmp_path / f"out{ending}"))
    shown = geometry.Mesh(stage.GetDefaultPrim())
    assert stage.GetTimeCodesPerSecond() == mesh.fps and geometry.GetStageMetersPerUnit(stage) == 1.0
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, len(mesh.frames) - 1)
    np.testing.assert_array_equal(np.array(shown.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3), mesh.triangles)
    np.testing.assert_allclose(np.array(shown.GetPointsAttr().Get()) * 1000, mesh.rest, atol=1e-4)
    for frame, vertices in enumerate(mesh.frames):
        np.testing.assert_allclose(np.array(shown.GetPointsAttr().Get(frame)) * 1000, vertices, atol=1e-4)


def test_without_its_package_usd_is_refused_in_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(EngineError, match="needs the package usd-core"):
        write(moving(), tmp_path / "out.usd")
    assert not (tmp_path / "out.usd").exists()


def test_an_npz_holds_the_vertices(tmp_path: Path) -> None:
    mesh = moving()
    write(mesh, tmp_path / "out.npz")
    with np.load(tmp_path / "out.npz", allow_pickle=False) as stored:
        np.testing.assert_array_equal(stored["vertices"], mesh.frames)
    with pytest.raises(FormatError, match="not a kind of file"):
        write(mesh, tmp_path / "out.fbx")
