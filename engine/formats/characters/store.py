"""Our own character file: one npz that `engine.character.load` reads."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from engine.character import Character
from engine.formats.atomic import write_bytes
from engine.take import SHAPES


def write(character: Character, path: Path) -> None:
    """Write a character; an existing file is replaced whole or left as it was."""
    moving = np.abs(character.deltas).max(axis=(1, 2)) > 0
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        vertices=character.neutral,
        faces=character.triangles,
        deltas=character.deltas[moving],
        shape_names=np.array([name for name, used in zip(SHAPES, moving, strict=True) if used], np.str_),
        colours=character.colours,
        landmark_names=np.array(list(character.landmarks), np.str_),
        landmark_vertices=np.array(list(character.landmarks.values()), np.int32),
    )
    write_bytes(path, [buffer.getvalue()])
