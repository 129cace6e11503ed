from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.character import Character, bundled
from engine.errors import EditError
from engine.spacetime.align import check_points
from engine.spacetime.layout import MARKERS, standard
from engine.take import SHAPES


def _renumbered(character: Character) -> Character:
    """The same head with its vertices in another order, as a rebuild may give."""
    order = np.random.default_rng(0).permutation(len(character.neutral))
    place = np.argsort(order)
    return replace(
        character,
        neutral=character.neutral[order],
        deltas=character.deltas[:, order],
        triangles=place[character.triangles].astype(np.int32),
        colours=character.colours[order],
        landmarks={name: int(place[vertex]) for name, vertex in character.landmarks.items()},
    )


def test_there_are_54_markers_at_places_of_their_own() -> None:
    character = bundled()
    layout = standard(character)
    assert len(MARKERS) == len(set(MARKERS)) == 54
    check_points(layout.rest(character), layout.names)
    gaps = np.linalg.norm(layout.rest(character)[:, None] - layout.rest(character)[None], axis=2)
    assert np.sort(gaps, axis=1)[:, 1].min() > 2  # mm


def test_left_and_right_mirror_each_other() -> None:
    character = bundled()
    place = dict(zip(MARKERS, standard(character).rest(character), strict=True))
    for name in MARKERS:
        if name.endswith("_left"):
            mirrored = place[name.replace("_left", "_right")] * [-1, 1, 1]
            np.testing.assert_allclose(place[name], mirrored, atol=1.5)
            assert place[name][0] > 0


def test_every_shape_but_gaze_and_tongue_moves_a_marker() -> None:
    character = bundled()
    moved = np.linalg.norm(standard(character).deltas(character), axis=2).max(axis=1)
    still = {shape for shape, distance in zip(SHAPES, moved, strict=True) if distance < 0.3}
    assert all("eyeLook" in shape or shape == "tongueOut" for shape in still)


def test_the_rule_finds_the_same_places_whatever_the_numbering() -> None:
    character = bundled()
    again = _renumbered(character)
    found, expected = standard(again).rest(again), standard(character).rest(character)
    np.testing.assert_allclose(found, expected, atol=1e-3)


def test_a_head_without_landmarks_is_told_which_it_lacks() -> None:
    character = replace(bundled(), landmarks={"nose_tip": 0, "chin": 1})
    with pytest.raises(EditError, match="lacks the landmarks nose_bridge, lip_upper"):
        standard(character)


def test_a_marker_that_is_not_there_is_named() -> None:
    with pytest.raises(EditError, match="'elbow'"):
        standard(bundled()).pick(["nose_tip", "elbow"])


def test_upper_and_lower_lip_keep_their_markers_where_mouth_corners_hang() -> None:
    character = bundled()
    hanging = character.neutral.copy()
    hanging[:, 1] -= 10 * (np.clip(np.abs(hanging[:, 0]) / 25, 0, 1)) ** 4
    drooping = replace(character, neutral=hanging)
    layout = standard(drooping)
    way = np.linalg.norm(layout.deltas(drooping)[SHAPES.index("jawOpen")], axis=1)
    by_name = dict(zip(layout.names, way, strict=True))
    for side in ("left", "right"):
        assert by_name[f"lip_upper_{side}"] < by_name[f"mouth_{side}"] < by_name[f"lip_lower_{side}"]
