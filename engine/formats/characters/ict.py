"""ICT-FaceKit: its folder of OBJ files, or the same packed into one npz."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.base.archive import arrays_of, names_in
from engine.formats.characters.raw import MAX_SHAPES, MAX_VERTICES, RawCharacter, check

KEYS = ("neutral", "faces", "shape_names", "deltas")


def is_ict(path: Path) -> bool:
    """Return whether an npz is a packed ICT-FaceKit."""
    return set(KEYS) <= names_in(path)


def read(path: Path) -> RawCharacter:
    """Read a packed ICT-FaceKit; raises `FormatError`."""
    stored = arrays_of(path, KEYS)
    try:
        neutral, faces = np.asarray(stored["neutral"], np.float64), stored["faces"]
        if stored["shape_names"].size > MAX_SHAPES:
            raise FormatError(f"{path.name} declares more data than a character can hold.")
        names = [str(name) for name in np.ravel(stored["shape_names"])]
        deltas = np.asarray(stored["deltas"], np.float32)
    except (KeyError, TypeError, ValueError) as error:
        raise FormatError(f"{path.name} is damaged or not an ICT-FaceKit.") from error
    sound = neutral.ndim == 2 and neutral.shape[1] == 3 and faces.ndim == 2 and faces.shape[1] in (3, 4)
    if not sound or deltas.shape != (len(names), *neutral.shape) or faces.dtype.kind not in "iu":
        raise FormatError(f"{path.name} has arrays whose sizes do not belong together.")
    if len(neutral) > MAX_VERTICES:
        raise FormatError(f"{path.name} declares more data than a character can hold.")
    return check(RawCharacter(path.stem, neutral, triangulated(faces), dict(zip(names, deltas, strict=True))))


def triangulated(faces: npt.NDArray[np.integer]) -> npt.NDArray[np.int32]:
    """Return triangles, (t, 3), of quads (f, 4) in which -1 ends a triangle."""
    if faces.shape[1] == 3:
        return faces.astype(np.int32)
    quads = faces[faces[:, 3] >= 0]
    single = faces[faces[:, 3] < 0][:, :3]
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], single]).astype(np.int32)
