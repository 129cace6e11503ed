"""The bundled head: sculpted, given its shapes and landmarks, and written as a character."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine import character
from engine.character import Character
from engine.lab.modelling.sculpture import Sculpture, sculpt
from engine.lab.modelling.shapes import shapes
from engine.take import SHAPES

MM_PER_CM = 10.0


def build(path: Path = character.BUNDLED) -> None:
    """Model the head and write it; the same program gives the same file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    character.save(model(), path)


def model() -> Character:
    """Return the head as a character, in millimetres."""
    head = sculpt()
    moved = shapes(head)
    return Character(
        neutral=(head.points * MM_PER_CM).astype(np.float32),
        triangles=head.triangles.astype(np.int32),
        deltas=np.stack([moved[name] * MM_PER_CM for name in SHAPES]).astype(np.float32),
        colours=(np.clip(head.colours, 0, 1) * 255).astype(np.uint8),
        landmarks=landmarks(head),
        mirror=head.mirror.astype(np.int32),
    )


def landmarks(head: Sculpture) -> dict[str, int]:
    """Return the vertices that the controls are measured between, by name."""
    mouth, eyes = head.topology.mouth, head.topology.eyes
    middle, left, right, corner = 12, 17, 7, 24  # of the upper lip; the lower lip runs back
    named = {
        "lip_inner_upper": mouth[8][middle],
        "lip_inner_lower": mouth[8][-middle],
        "lip_upper": mouth[5][middle],
        "lip_lower": mouth[5][-middle],
        "mouth_left": mouth[6][corner],
        "mouth_right": mouth[6][0],
        "lip_inner_upper_left": mouth[8][left],
        "lip_inner_lower_left": mouth[8][-left],
        "lip_inner_upper_right": mouth[8][right],
        "lip_inner_lower_right": mouth[8][-right],
        "nose_bridge": _nearest(head, (0, 0.3, 9.4)),
        "chin": _nearest(head, (0, -9.9, 9.9)),
        "nose_tip": _nearest(head, (0, -3.1, 11.6)),
    }
    for side in ("left", "right"):
        margin = eyes[side][9]
        named |= {f"lid_upper_{side}": margin[9], f"lid_lower_{side}": margin[27]}
    return named


def _nearest(head: Sculpture, place: npt.ArrayLike) -> int:
    return int(np.linalg.norm(head.skin - np.asarray(place), axis=1).argmin())
