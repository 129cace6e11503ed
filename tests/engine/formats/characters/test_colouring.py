from __future__ import annotations

import numpy as np

from engine.character import bundled
from engine.formats.characters.colouring import LASH, MOUTH, PUPIL, SKIN, TOOTH, WHITE, colours_of
from engine.mesh import parts_of

POINTS, TRIANGLES = bundled().neutral.astype(np.float64), bundled().triangles


def test_eyes_teeth_and_mouth_are_told_from_skin() -> None:
    colours = colours_of(POINTS, TRIANGLES, bundled().landmarks)
    parts = parts_of(TRIANGLES, len(POINTS))
    skin = parts == np.argmax(np.bincount(parts))
    assert (colours[skin] == SKIN).all()
    painted = {tuple(colour) for colour in colours[~skin].tolist()}
    assert {WHITE, TOOTH, MOUTH, LASH} <= painted


def test_the_pupil_looks_ahead_out_of_the_middle_of_each_eye() -> None:
    colours = colours_of(POINTS, TRIANGLES, bundled().landmarks).astype(int)
    for side, sign in (("left", 1), ("right", -1)):
        lids = POINTS[[bundled().landmarks[f"lid_{place}_{side}"] for place in ("upper", "lower")]].mean(axis=0)
        near = (np.abs(POINTS - lids)[:, :2].max(axis=1) < 15) & (POINTS[:, 0] * sign > 0)
        dark = near & (colours == PUPIL).all(axis=1)
        assert dark.any() and np.abs(POINTS[dark].mean(axis=0) - lids)[:2].max() < 6


def test_without_landmarks_all_is_skin() -> None:
    assert (colours_of(POINTS, TRIANGLES, {"chin": 0}) == SKIN).all()
