"""The character: a mesh with shapes, landmarks and colours; weights become vertices."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from engine import assets
from engine.errors import AssetError, EditError, EngineError
from engine.formats.base.archive import arrays_of
from engine.formats.base.atomic import write_bytes
from engine.jaw import drawable
from engine.take import SHAPE_INDEX, SHAPES, Array, Take

BUNDLED = assets.HEAD
SPLIT = ("split", "split_triangles")
REQUIRED = ("vertices", "faces", "shape_names", "deltas", "colours", "landmark_names", "landmark_vertices")
FARTHEST_MM = 1e6
MAX_NAME = 80  # letters shown on screen
UNTOLD = 0.02  # a weight below this is not worth a word
MAX_NAMES = 10_000  # of shapes, of landmarks


@dataclass(frozen=True, eq=False)
class Character:
    """A blendshape head in its own file's frame: millimetres, Y up, Z forward, the character's left at +X.

    Attributes
    ----------
    neutral : (vertices, 3) float32, mm
    triangles : (triangles, 3) int32
    deltas : (52, vertices, 3) float32, mm, in the order of `SHAPES`; a shape it lacks is all zero
    colours : (vertices, 3) uint8, sRGB
    landmarks : vertex index by name
    mirror : (vertices,) int32, each vertex's mirror image; empty where the mesh has none
    name : what to call it on screen
    split : (vertices of the file it came from,) int32, which vertex each is here; empty where they are the same
    split_triangles : (triangles of that file, 3) int32, of its own vertices; empty where they are the same
    """

    neutral: npt.NDArray[np.float32]
    triangles: npt.NDArray[np.int32]
    deltas: npt.NDArray[np.float32]
    colours: npt.NDArray[np.uint8]
    landmarks: dict[str, int]
    name: str = "Retake head"
    mirror: npt.NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    split: npt.NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    split_triangles: npt.NDArray[np.int32] = field(default_factory=lambda: np.zeros((0, 3), np.int32))

    @cached_property
    def _moving(self) -> npt.NDArray[np.int64]:
        moving = np.zeros(len(self.neutral), bool)
        for delta in self.deltas:  # all at once would take as much memory again
            moving |= delta.any(axis=1)
        return np.flatnonzero(moving)

    @cached_property
    def _basis(self) -> npt.NDArray[np.float32]:
        """(52, 3 x moving vertices): one matrix product moves a face."""
        return np.ascontiguousarray(self.deltas[:, self._moving].reshape(len(SHAPES), -1))

    def vertices(self, weights: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """Return posed vertices, (vertices, 3) float32 in mm, for one frame of weights, (52,)."""
        used = drawable(np.asarray(weights, np.float32))
        posed = self.neutral.copy()
        posed[self._moving] += (used @ self._basis).reshape(-1, 3)
        return posed

    @cached_property
    def lacking(self) -> tuple[str, ...]:
        """Names of the shapes that the head has not."""
        return tuple(name for name, delta in zip(SHAPES, self.deltas, strict=True) if not delta.any())

    @property
    def triangles_in_file(self) -> npt.NDArray[np.int32]:
        """The triangles of the file's own vertices, (t, 3)."""
        return self.split_triangles if len(self.split) else self.triangles

    def as_in_file(self, vertices: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return values of vertices, (..., vertices, 3), for each vertex of the file the head came from."""
        return vertices[..., self.split, :] if len(self.split) else vertices

    def vertex_of(self, number: int) -> int:
        """Return the vertex that a vertex of the file is here; raises `EditError` where the file has no such number."""
        count = len(self.split) or len(self.neutral)
        if not 0 <= number < count:
            raise EditError(f"{self.name} has no vertex {number}.", f"It has {count:,}, counted from 0.")
        return int(self.split[number]) if len(self.split) else number

    def number_of(self, vertex: int) -> int:
        """Return the number that the file has for a vertex, the first where it has several."""
        return int(np.argmax(self.split == vertex)) if len(self.split) else vertex

    def landmark_positions(self, names: Sequence[str]) -> tuple[Array, Array]:
        """Return the neutral (n, 3) and the deltas (52, n, 3) of named landmarks, float64, mm."""
        missing = [name for name in names if name not in self.landmarks]
        if missing:
            raise AssetError(f"The character {self.name!r} has no landmark {missing[0]!r}.")
        vertices = [self.landmarks[name] for name in names]
        return self.neutral[vertices].astype(np.float64), self.deltas[:, vertices].astype(np.float64)


def without_lacking(take: Take, character: Character) -> Take:
    """Return a take without what a head cannot do: weights of shapes it has not are 0, and what is lost so is said."""
    lacking = [SHAPE_INDEX[name] for name in character.lacking]
    lost = [SHAPES[column] for column in lacking if (take.weights[:, column] > UNTOLD).any()]
    if not take.weights[:, lacking].any():
        return take
    weights = take.weights.copy()
    weights[:, lacking] = 0.0
    shown = ", ".join(lost[:4]) + (f" and {len(lost) - 4} more" if len(lost) > 4 else "")
    notices_added = (
        (f"{character.name} has no {shown}: what the source does there is not in the new take.",) if lost else ()
    )
    return replace(take, weights=weights, notices=(*take.notices, *notices_added))


def load(path: Path = BUNDLED) -> Character:
    """Read a character written by `save`; raises `AssetError` where the file is missing or damaged."""
    try:
        return _sound(_stored(arrays_of(path, (*REQUIRED, "name", "mirror", *SPLIT))))
    except (EngineError, KeyError, ValueError, TypeError, IndexError, OverflowError) as error:
        raise AssetError(
            f"The character file {path.name} is missing or damaged.",
            "Rebuild it: retake build head." if path == BUNDLED else "Import it again: retake character import.",
        ) from error


def _stored(arrays: Mapping[str, npt.NDArray[Any]]) -> Character:
    if max(arrays["shape_names"].size, arrays["landmark_names"].size) > MAX_NAMES:
        raise ValueError("more names than a head has")
    vertices = arrays["vertices"].astype(np.float32, casting="same_kind")
    deltas = np.zeros((len(SHAPES), *vertices.shape), np.float32)
    for name, delta in zip(arrays["shape_names"], arrays["deltas"], strict=True):
        deltas[SHAPE_INDEX[str(name)]] = delta
    pairs = zip(arrays["landmark_names"], arrays["landmark_vertices"], strict=True)
    return Character(
        vertices,
        arrays["faces"].astype(np.int32, casting="same_kind"),
        deltas,
        arrays["colours"].astype(np.uint8, casting="same_kind"),
        {str(name): int(vertex) for name, vertex in pairs},
        name=str(arrays["name"])[:MAX_NAME] if "name" in arrays else Character.name,
        mirror=arrays.get("mirror", np.zeros(0)).astype(np.int32, casting="unsafe"),
        **{name: arrays[name].astype(np.int32, casting="same_kind") for name in SPLIT if name in arrays},
    )


def _sound(made: Character) -> Character:
    """Return a character whose arrays belong together; raises `ValueError` for another."""
    count = len(made.neutral)
    landmarks = np.array(list(made.landmarks.values()), np.int64)
    indices = np.concatenate([made.triangles.ravel(), made.mirror, made.split.ravel(), landmarks])
    shapes = made.neutral.shape == made.colours.shape == (count, 3) and made.triangles.shape[1:] == (3,)
    places = [made.neutral, *made.deltas]
    if not (count and len(made.triangles) and shapes and made.mirror.shape in ((0,), (count,))):
        raise ValueError("arrays whose sizes do not belong together")
    corners = made.split_triangles
    if made.split.ndim != 1 or corners.shape[1:] != (3,) or (len(made.split) > 0) != (len(corners) > 0):
        raise ValueError("a map of vertices that does not belong to its faces")
    if len(corners) and not 0 <= corners.min() <= corners.max() < len(made.split):
        raise ValueError("a face of the file with a vertex that is not there")
    if not all(bool((np.abs(place) < FARTHEST_MM).all()) for place in places):
        raise ValueError("a place that is not finite, or further away than a head can be")
    if not 0 <= indices.min() <= indices.max() < count:
        raise ValueError("a vertex that is not there")
    return made


def save(character: Character, path: Path) -> None:
    """Write a character for `load`; deltas are kept as half floats, good to 0.02 mm. Equal characters, equal bytes.

    Raises `EngineError` when the folder cannot be written or the disk is full.
    """
    stored = io.BytesIO()
    np.savez_compressed(
        stored,
        vertices=character.neutral,
        faces=character.triangles,
        colours=character.colours,
        shape_names=np.array(SHAPES),
        deltas=character.deltas.astype(np.float16),
        landmark_names=np.array(list(character.landmarks)),
        landmark_vertices=np.array(list(character.landmarks.values()), np.int32),
        mirror=character.mirror,
        **({name: getattr(character, name) for name in SPLIT} if len(character.split) else {}),
        name=np.array(character.name),
    )
    write_bytes(path, [stored.getvalue()])


@lru_cache(maxsize=1)
def bundled() -> Character:
    """Return the head that ships with the program; controls are measured on it whatever is shown."""
    return load()
