"""ICT-FaceKit: its folder of OBJ files, or the same packed into one npz."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.characters.raw import MAX_SHAPES, MAX_VERTICES, RawCharacter, check

KEYS = ("neutral", "faces", "shape_names", "deltas")
MAX_BYTES = 4 << 30


def is_ict(path: Path) -> bool:
    """Return whether an npz is a packed ICT-FaceKit."""
    try:
        with zipfile.ZipFile(path) as archive:
            return {f"{key}.npy" for key in KEYS} <= set(archive.namelist())
    except (OSError, zipfile.BadZipFile):
        return False


def read(path: Path) -> RawCharacter:
    """Read a packed ICT-FaceKit; raises `FormatError`."""
    try:
        _check_declared(path)
        with np.load(path, allow_pickle=False) as stored:
            neutral, faces = np.asarray(stored["neutral"], np.float64), np.asarray(stored["faces"])
            names = [str(name) for name in stored["shape_names"]]
            deltas = np.asarray(stored["deltas"], np.float32)
    except (OSError, KeyError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise FormatError(f"{path.name} is damaged or not an ICT-FaceKit.") from error
    if neutral.ndim != 2 or faces.ndim != 2 or deltas.shape != (len(names), *neutral.shape):
        raise FormatError(f"{path.name} has arrays whose sizes do not belong together.")
    return check(RawCharacter(path.stem, neutral, triangulated(faces), dict(zip(names, deltas, strict=True))))


def _check_declared(path: Path) -> None:
    """Refuse an archive that would unpack to more than a character can be, before memory is taken."""
    with zipfile.ZipFile(path) as archive:
        if sum(entry.file_size for entry in archive.infolist()) > MAX_BYTES:
            raise FormatError(f"{path.name} declares more data than a character can hold.")
        for key in KEYS:
            with archive.open(f"{key}.npy") as file:
                version = np.lib.format.read_magic(file)
                reader = (
                    np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
                )
                shape, _, dtype = reader(file)
            size = int(np.prod(shape, dtype=object)) * dtype.itemsize
            if size > archive.getinfo(f"{key}.npy").file_size or (
                len(shape) and shape[0] > max(MAX_VERTICES, MAX_SHAPES)
            ):
                raise FormatError(f"{path.name} declares more data than it holds.")


def triangulated(faces: npt.NDArray[np.integer]) -> npt.NDArray[np.int32]:
    """Return triangles, (t, 3), of quads (f, 4) in which -1 ends a triangle."""
    if faces.shape[1] == 3:
        return faces.astype(np.int32)
    quads = faces[faces[:, 3] >= 0]
    single = faces[faces[:, 3] < 0][:, :3]
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], single]).astype(np.int32)
