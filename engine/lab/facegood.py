"""FACEGOOD animation archives: mouth and jaw curves under a production rig's names, mapped to ARKit by a table."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from engine.errors import FormatError
from engine.formats.base.archive import arrays_of
from engine.take import SHAPE_INDEX, SHAPES, Take

MAX_FRAMES = 10_000_000


def read(path: Path) -> Take:
    """Read an archive of `weights` (frames, rig curves), `names` and `fps`; the mapping table lies beside it.

    Only the mouth and jaw are animated in these takes: all other shapes are zero. Raises `FormatError`.
    """
    try:
        archive = arrays_of(path, ("weights", "names", "fps"))
        curves = {str(name): archive["weights"][:, i] for i, name in enumerate(archive["names"])}
        fps = float(archive["fps"])
    except (FormatError, KeyError, ValueError, IndexError, TypeError) as error:
        raise FormatError(f"{path.name} is not a FACEGOOD animation archive.") from error
    frames = len(next(iter(curves.values())))
    weights = np.zeros((frames, len(SHAPES)))
    for shape, sources in _mapping(path.with_name("arkit_mapping.csv")).items():
        present = [curves[source] for source in sources if source in curves]
        if present:
            weights[:, SHAPE_INDEX[shape]] = np.max(present, axis=0)
    return Take(weights=weights, fps=fps, name=path.name)


def _mapping(path: Path) -> dict[str, list[str]]:
    """Return the source curves of each shape that the table calls valid; several stand for their maximum."""
    try:
        rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
        return {
            row["arkit"]: row["facegood"].removeprefix("max(").removesuffix(")").split(",")
            for row in rows
            if row["status"] == "valid" and row["arkit"] in SHAPE_INDEX
        }
    except (OSError, KeyError, UnicodeDecodeError, AttributeError) as error:
        raise FormatError(f"{path.name}, which names the curves of a FACEGOOD archive, could not be read.") from error
