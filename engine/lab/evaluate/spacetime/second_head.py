"""The second head, ICT-FaceKit, read from the folder of recorded takes: something to carry a performance to."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from engine.character import Character
from engine.errors import AssetError
from engine.spacetime.align import Warp
from engine.spacetime.layout import Layout, standard
from engine.take import SHAPES

MM_PER_CM = 10.0
FACE_VERTICES = 9409  # the face comes first; then head, teeth, eyes, lashes
WHOLE = {"browInnerUp": ("browInnerUp_L", "browInnerUp_R"), "cheekPuff": ("cheekPuff_L", "cheekPuff_R")}
# Our landmark by its number among the usual 68 of a face.
LANDMARKS = {
    "chin": 8,
    "nose_bridge": 27,
    "nose_tip": 30,
    "mouth_right": 48,
    "lip_upper": 51,
    "mouth_left": 54,
    "lip_lower": 57,
    "lip_inner_upper_right": 61,
    "lip_inner_upper": 62,
    "lip_inner_upper_left": 63,
    "lip_inner_lower_left": 65,
    "lip_inner_lower": 66,
    "lip_inner_lower_right": 67,
    "lid_upper_right": 37,
    "lid_lower_right": 41,
    "lid_upper_left": 44,
    "lid_lower_left": 46,
}


def load(folder: Path) -> Character:
    """Return the head of a data folder, in millimetres; raises `AssetError` where it is missing or damaged."""
    home = folder / "ict_facekit"
    try:
        with np.load(home / "ict_facekit.npz", allow_pickle=False) as stored:
            shapes = {str(name): delta for name, delta in zip(stored["shape_names"], stored["deltas"], strict=True)}
            neutral, faces = stored["neutral"] * np.float32(MM_PER_CM), stored["faces"]
        numbered = json.loads((home / "FaceXModel" / "vertex_indices.json").read_text())["idx_to_landmark_verts"]
        landmarks = {name: int(numbered[number]) for name, number in LANDMARKS.items()}
    except (OSError, KeyError, ValueError, IndexError) as error:
        raise AssetError(
            "The second head, ict_facekit, is missing or damaged.", "Set RETAKE_DATA to the folder that holds it."
        ) from error
    deltas = np.stack([_delta(name, shapes, neutral) for name in SHAPES])
    colours = np.full(neutral.shape, 200, np.uint8)
    return Character(neutral, _triangles(faces), deltas, colours, landmarks, "ICT FaceKit")


def _delta(
    name: str, shapes: dict[str, npt.NDArray[np.float32]], neutral: npt.NDArray[np.float32]
) -> npt.NDArray[np.float32]:
    parts = WHOLE.get(name, (name.replace("Left", "_L").replace("Right", "_R"),))
    if name in ("jawLeft", "jawRight", "mouthLeft", "mouthRight"):
        parts = (name,)
    found = [shapes[part] for part in parts if part in shapes]
    if not found and name != "tongueOut":
        raise KeyError(name)
    return np.asarray(sum(found, np.zeros_like(neutral)) * np.float32(MM_PER_CM))


def _triangles(faces: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    quads = faces[faces[:, 3] >= 0]
    return np.concatenate([faces[:, :3], quads[:, [0, 2, 3]]]).astype(np.int32)


def layout(head: Character, bundled: Character) -> Layout:
    """Return the 54 markers on the head: landmarks where they are, the others nearest to where the warp puts ours."""
    shared = [name for name in LANDMARKS if not name.startswith("lip_inner_lower")]  # those lie on the upper ones
    ours, theirs = (
        face.neutral[[face.landmarks[name] for name in shared]].astype(np.float64) for face in (bundled, head)
    )
    placed = standard(bundled)
    target = Warp(ours, theirs, shared)(placed.rest(bundled))
    _, nearest = cKDTree(head.neutral[:FACE_VERTICES]).query(target)
    found = zip(placed.names, np.atleast_1d(nearest).tolist(), strict=True)
    vertices = np.array([head.landmarks.get(name, vertex) for name, vertex in found], np.int64)
    return Layout(placed.names, vertices)
