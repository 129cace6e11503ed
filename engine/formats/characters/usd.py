"""A moving mesh as USD: one UsdGeomMesh whose points are sampled over time, in metres, Y up."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from engine.errors import EngineError
from engine.formats.base.atomic import write_bytes
from engine.formats.characters.moving import MovingMesh

ENDINGS = (".usd", ".usdc", ".usda")
METRES_PER_MM = 0.001


def write(mesh: MovingMesh, path: Path) -> None:
    """Write a mesh with a sample of its points at each frame; one time code is one frame.

    Raises `EngineError` where usd-core is not installed or the file cannot be written.
    """
    try:
        from pxr import Gf, Sdf, Usd, UsdGeom, Vt
    except ImportError:
        raise EngineError("USD needs the package usd-core.", "Install it with: pip install 'retake[usd]'.") from None
    with tempfile.TemporaryDirectory() as folder:
        written = Path(folder) / f"mesh{path.suffix.lower()}"
        stage = Usd.Stage.CreateNew(str(written))
        UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
        UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        stage.SetTimeCodesPerSecond(mesh.fps)
        stage.SetFramesPerSecond(mesh.fps)
        stage.SetStartTimeCode(0)
        stage.SetEndTimeCode(max(len(mesh.frames) - 1, 0))
        shown = UsdGeom.Mesh.Define(stage, "/Head")
        stage.SetDefaultPrim(shown.GetPrim())
        shown.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        shown.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(mesh.triangles), 3, np.int32)))
        shown.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(mesh.triangles.astype(np.int32).ravel()))
        points, extent = shown.CreatePointsAttr(), shown.CreateExtentAttr()
        points.Set(Vt.Vec3fArray.FromNumpy((mesh.rest * METRES_PER_MM).astype(np.float32)))
        with Sdf.ChangeBlock():
            for frame, vertices in enumerate(mesh.frames):
                placed = (vertices * np.float32(METRES_PER_MM)).astype(np.float32)
                points.Set(Vt.Vec3fArray.FromNumpy(placed), frame)
                ends = [Gf.Vec3f(*map(float, end)) for end in (placed.min(axis=0), placed.max(axis=0))]
                extent.Set(Vt.Vec3fArray(ends), frame)
        stage.Save()
        write_bytes(path, [written.read_bytes()])
