"""The bundled head: sculpted, given its shapes and landmarks, and written as a character."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine import assets, character
from engine.character import Character
from engine.lab.sculpting.sculpture import Sculpture, sculpt
from engine.lab.sculpting.shapes import shapes
from engine.take import SHAPES, Array

MM_PER_CM = 10.0
FAINT_MM = 0.05  # a vertex that a shape moves less stands still in it: smaller files, fewer vertices to move


def build(path: Path = assets.SECOND_HEAD) -> None:
    """Model the head and write it; the same program gives the same file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    character.save(model(), path)


def model() -> Character:
    """Return the head as a character, in millimetres."""
    head = sculpt()
    moved = {name: _without_faint(motion * MM_PER_CM) for name, motion in shapes(head).items()}
    return Character(
        neutral=(head.points * MM_PER_CM).astype(np.float32),
        triangles=head.triangles.astype(np.int32),
        deltas=np.stack([moved[name] for name in SHAPES]).astype(np.float32),
        colours=(np.clip(head.colours, 0, 1) * 255).astype(np.uint8),
        landmarks=landmarks(head),
        mirror=head.mirror.astype(np.int32),
        name="Second head",
    )


def _without_faint(motion: Array) -> Array:
    return np.where(np.linalg.norm(motion, axis=1, keepdims=True) < FAINT_MM, 0.0, motion)


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
        "nose_bridge": _nearest(head, (0, 0.0, 10.7)),
        "chin": _nearest(head, (0, -10.6, 10.9)),
        "nose_tip": _nearest(head, (0, -3.6, 13.0)),
    }
    for side in ("left", "right"):
        margin = eyes[side][9]
        named |= {f"lid_upper_{side}": margin[9], f"lid_lower_{side}": margin[27]}
    return named


def _nearest(head: Sculpture, place: npt.ArrayLike) -> int:
    return int(np.linalg.norm(head.skin - np.asarray(place), axis=1).argmin())
