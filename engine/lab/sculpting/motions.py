"""The motion of every shape by its handles: fitted to paths that were measured on sculpted scans."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from engine.take import Array

FITTED = Path(__file__).with_name("motions.json")


@dataclass(frozen=True, eq=False)
class Motion:
    """How one shape moves the face.

    Attributes
    ----------
    moves : (2 h, 3) of all handles in cm, those of the left half first
    lids : degrees that the left upper and lower lid rise on the eyeball
    jaw : degrees that the lower teeth turn about x at the hinge
    jaw_shift : (3,) their shift in cm
    """

    moves: Array
    lids: tuple[float, float]
    jaw: float
    jaw_shift: Array


@lru_cache(maxsize=1)
def fitted(path: Path = FITTED) -> tuple[tuple[str, ...], dict[str, Motion]]:
    """Return the names of the handles and the motion of each shape of the left half and the middle."""
    stored = json.loads(path.read_text())
    motions = {
        name: Motion(
            moves=np.array(each["left"] + each["right"], np.float64),
            lids=(each["lids"][0], each["lids"][1]),
            jaw=each["jaw"][0],
            jaw_shift=np.array(each["jaw"][1:]),
        )
        for name, each in stored["shapes"].items()
    }
    return tuple(stored["handles"]), motions
