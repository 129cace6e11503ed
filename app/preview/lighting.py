"""Light per vertex in numpy: on software GL a shader per pixel costs three times as much as the whole drawing."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from engine.character import Character

Floats = npt.NDArray[np.float32]
_STEPS = 4096  # of the table that turns linear light into sRGB


def _direction(*axis: float) -> Floats:
    vector = np.array(axis, np.float32)
    return np.asarray(vector / np.linalg.norm(vector), np.float32)


KEY, FILL, RIM = _direction(-0.5, 0.6, 1.0), _direction(0.9, 0.1, 0.5), _direction(0.35, 0.45, -1.0)
EYE_LIGHT = _direction(-0.32, 0.38, 1.0)  # nearer to the eye than the key, or the lids would cover its mirror image
WARM, COOL = np.array([1.0, 0.96, 0.91], np.float32), np.array([0.78, 0.88, 1.0], np.float32)


def to_linear(srgb: npt.NDArray[np.uint8]) -> Floats:
    """Return linear light, 0..1, of sRGB bytes."""
    value = srgb.astype(np.float32) / 255.0
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4).astype(np.float32)


class Lighting:
    """A warm key with soft wrap, a cool fill, a rim from behind and a little sky.

    Parameters
    ----------
    character : whose triangles carry the light; normals are summed over them by one sparse product
    wet : the vertices of eyeballs, in which the light is mirrored
    """

    def __init__(self, character: Character, wet: npt.NDArray[np.int64] | None = None) -> None:
        # here and not above: scipy takes a third of a second to load, and the window should be seen first
        from scipy import sparse

        self._triangles = character.triangles
        faces, vertices = len(character.triangles), len(character.neutral)
        corners = (np.ones(3 * faces, np.float32), (character.triangles.ravel(), np.repeat(np.arange(faces), 3)))
        self._gather = sparse.csr_matrix(corners, shape=(vertices, faces))
        self._linear = to_linear(character.colours)
        self._wet = np.zeros(0, np.int64) if wet is None else wet
        grid = np.linspace(0.0, 1.0, _STEPS)
        encoded = np.where(grid <= 0.0031308, 12.92 * grid, 1.055 * grid ** (1 / 2.4) - 0.055)
        self._to_srgb = encoded.astype(np.float32)

    def normals(self, vertices: Floats) -> Floats:
        """Return unit normals, (vertices, 3), weighted by the area of the triangles around each vertex."""
        corner = vertices[self._triangles]
        edge, other = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        crossed = np.empty_like(edge)
        for axis in range(3):  # np.cross takes three times as long
            left, right = (axis + 1) % 3, (axis + 2) % 3
            crossed[:, axis] = edge[:, left] * other[:, right] - edge[:, right] * other[:, left]
        summed = self._gather @ crossed
        summed /= np.sqrt(np.einsum("vx,vx->v", summed, summed))[:, None] + 1e-12
        return np.asarray(summed, np.float32)

    def shade(self, vertices: Floats, eye: Floats, linear: Floats | None = None) -> Floats:
        """Return sRGB colours, (vertices, 3) in 0..1, of vertices seen from `eye`, (3,).

        `linear` replaces the character's own colours, (vertices, 3) in linear light.
        """
        normals = self.normals(vertices)
        view = eye - vertices
        view /= np.sqrt(np.einsum("vx,vx->v", view, view))[:, None]
        key = np.clip((normals @ KEY + 0.28) / 1.28, 0.0, 1.0) ** 1.3
        fill = np.clip(normals @ FILL, 0.0, 1.0)
        facing = np.clip(np.einsum("vx,vx->v", normals, view), 0.0, 1.0)
        rim = np.clip(normals @ RIM + 0.2, 0.0, 1.0) * (1.0 - facing) ** 2
        sky = 0.24 + 0.16 * normals[:, 1]
        half = view + KEY
        half /= np.sqrt(np.einsum("vx,vx->v", half, half))[:, None]
        shine = 0.07 * np.clip(np.einsum("vx,vx->v", normals, half), 0.0, 1.0) ** 24
        shine[self._wet] = _glint(normals[self._wet], view[self._wet])
        light = 0.92 * key[:, None] * WARM + 0.20 * fill[:, None] * COOL + sky[:, None] + 0.75 * rim[:, None] * COOL
        lit = (self._linear if linear is None else linear) * light + shine[:, None]
        return np.asarray(self._to_srgb[(np.clip(lit, 0.0, 1.0) * (_STEPS - 1)).astype(np.int32)], np.float32)


def _glint(normals: Floats, view: Floats) -> Floats:
    """Return the light mirrored in wet eyes, (n,): eyes without one look blind."""
    half = view + EYE_LIGHT
    half /= np.sqrt(np.einsum("vx,vx->v", half, half))[:, None]
    return np.asarray(0.9 * np.clip(np.einsum("vx,vx->v", normals, half), 0.0, 1.0) ** 220, np.float32)
