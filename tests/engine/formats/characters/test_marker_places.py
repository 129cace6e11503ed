"""Markers by any name are understood by where they are, and the head's own motion is kept."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from engine.character import bundled
from engine.errors import EditError
from engine.formats import markers
from engine.formats.characters.marker_places import match_markers, places_on
from engine.spacetime.layout import MARKERS, standard
from engine.spacetime.retarget import retarget
from engine.spacetime.source import from_markers
from engine.take import SHAPE_INDEX, SHAPES
from tests.heads import FOREIGN, capture

Z_UP = np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]])  # our rows to a lab with z up


def talking(frames: int = 40) -> np.ndarray:
    weights = np.zeros((frames, len(SHAPES)))
    weights[:, SHAPE_INDEX["jawOpen"]] = 0.6 * np.sin(np.linspace(0, np.pi, frames)) ** 2
    return weights


@pytest.mark.parametrize("turn", [np.eye(3), Z_UP, Z_UP @ Rotation.from_euler("z", 45, degrees=True).as_matrix().T])
@pytest.mark.parametrize("scale", [1.0, 0.1])
def test_markers_of_another_studio_are_told_by_their_places(turn: np.ndarray, scale: float) -> None:
    found = capture(talking(), turn=turn)
    table = match_markers(found.positions[0] * scale, found.names)
    assert {row.marker: row.landmark for row in table.rows} == {other: own for own, other in FOREIGN.items()}
    assert all(row.how == "by place" for row in table.rows)
    np.testing.assert_allclose(turn @ table.turn, np.eye(3), atol=0.02)


def test_markers_without_any_meaning_in_their_names_are_told_too() -> None:
    names = {own: f"M{number:02}" for number, own in enumerate(MARKERS)}
    found = capture(talking(), names, turn=Z_UP)
    table = match_markers(found.positions[0], found.names)
    assert {row.marker: row.landmark for row in table.rows} == {other: own for own, other in names.items()}


def test_names_of_landmarks_are_taken_at_their_word_in_any_spelling() -> None:
    names = {own: own.upper().replace("_", " ") for own in MARKERS}
    table = match_markers(capture(talking(), names).positions[0], list(names.values()))
    assert [row.landmark for row in table.rows] == list(MARKERS)
    assert {row.how for row in table.rows} == {"by name"}


def test_a_landmark_s_own_name_wins_over_another_spelling_of_it() -> None:
    points = capture(talking(), {own: own for own in MARKERS}).positions[0]
    table = match_markers(np.concatenate([points[:1] + 30.0, points]), ["Fore Head", *MARKERS])
    assert [row.landmark for row in table.rows] == ["", *MARKERS]


def test_a_capture_with_other_names_moves_the_head_as_one_with_ours() -> None:
    played, turns = (
        talking(),
        Rotation.from_euler("yxz", np.linspace([0, 0, 0], [20, 8, -5], 40), degrees=True).as_matrix(),
    )
    ours = from_markers(capture(played, {name: name for name in FOREIGN}, heads=turns))
    found = capture(played, turn=Z_UP, heads=turns)
    table = match_markers(found.positions[0], found.names)
    other = from_markers(found, turn=table.turn, landmarks=table.landmarks)
    np.testing.assert_allclose(other.gaps, ours.gaps, atol=1e-6)
    np.testing.assert_allclose(other.take.rotations[:, :3], ours.take.rotations[:, :3], atol=0.01)
    from engine.spacetime.layout import named

    made = retarget(other, bundled(), layout=named(places_on(bundled(), other.neutral, other.names, table)))
    jaw = SHAPE_INDEX["jawOpen"]
    assert abs(made.weights[20, jaw] - played[20, jaw]) < 0.15
    np.testing.assert_array_equal(made.rotations, other.take.rotations)


def test_a_correction_has_the_last_word_and_what_is_not_there_is_named() -> None:
    found = capture(talking())
    table = match_markers(found.positions[0], found.names).corrected({"Mouth_Up": "philtrum", "Lcheek": ""})
    landmarks = table.landmarks
    assert landmarks["Mouth_Up"] == "philtrum" and "Lcheek" not in landmarks and table.left_out == {"Lcheek"}
    places = places_on(bundled(), found.positions[0], found.names, table)
    layout = standard(bundled())
    assert places["Mouth_Up"] == layout.vertices[layout.names.index("philtrum")] and "Lcheek" not in places
    with pytest.raises(EditError, match="no marker called 'Mund'"):
        table.corrected({"Mund": "chin"})
    with pytest.raises(EditError, match="no marker place called 'beard'"):
        table.corrected({"Chin_M": "beard"})


@pytest.mark.parametrize("points", [np.zeros((20, 3)), np.random.default_rng(0).normal(size=(20, 3)) * 50])
def test_markers_that_are_no_face_are_refused_with_advice(points: np.ndarray) -> None:
    with pytest.raises(EditError) as caught:
        match_markers(points, [f"M{number}" for number in range(20)])
    assert caught.value.advice


def test_a_few_markers_by_other_names_are_refused_and_by_our_names_are_not() -> None:
    points = np.random.default_rng(0).normal(size=(5, 3))
    with pytest.raises(EditError, match="too few to find the others"):
        match_markers(points, list("abcde"))
    assert len(match_markers(points, MARKERS[:5]).landmarks) == 5


@pytest.mark.parametrize("name", ["Jaw", "Cheeks", "Nose", "Eyebrows"])
def test_a_real_optical_capture_is_understood(name: str, real_take_path: Path) -> None:
    path = real_take_path.parent.parent / "animface" / f"{name}.trc"
    if not path.exists():
        pytest.skip(f"needs the optical capture in {os.environ.get('RETAKE_DATA', 'the recorded data')}")
    read = markers.read(path)
    landmarks = match_markers(read.positions[0], read.names).landmarks
    right = {
        "Mouth_Up": "lip_upper", "Mouth_Down": "lip_lower", "Mouth_Lend": "mouth_left", "Mouth_Rend": "mouth_right",
        "Leye_Up": "lid_upper_left", "Leye_Down": "lid_lower_left", "Reye_Up": "lid_upper_right", "Chin": "chin",
        "Reye_Down": "lid_lower_right", "Leyebrow_Inside": "brow_inner_left", "Reyebrow_Outside": "brow_outer_right",
        "ForeHead_M": "forehead", "NoseTop": "nose_bridge",
    }  # fmt: skip
    assert {marker: landmarks.get(marker) for marker in right} == right
    assert all(not ("left" in place and marker.startswith("R")) for marker, place in landmarks.items())


SAID = {
    "mouth_left": "Face:LMouthCorner",
    "mouth_right": "lip_corner_R",
    "lip_upper": "UpperLip",
    "lip_lower": "Mouth_Down",
    "chin": "Chin",
    "nose_tip": "NoseTip",
    "brow_inner_left": "LBrowIn",
    "eye_outer_right": "Reye_Outside",
}


@pytest.mark.parametrize("turn", [np.eye(3), Z_UP])
def test_a_few_markers_are_told_by_words_where_their_places_tell_nothing(turn: np.ndarray) -> None:
    cap = np.random.default_rng(2).normal(0, 150, (7, 3))  # and a cap's, anywhere
    found = capture(talking(), SAID, turn=turn)
    points = np.concatenate([found.positions[0], cap])
    names = (*found.names, *(f"Cap{number}" for number in range(7)))
    table = match_markers(points, names)
    assert table.landmarks == {marker: landmark for landmark, marker in SAID.items()}
    np.testing.assert_allclose(turn @ table.turn, np.eye(3), atol=0.02)
    few = match_markers(found.positions[0][:5], found.names[:5])
    assert few.landmarks == {name: {v: k for k, v in SAID.items()}[name] for name in found.names[:5]}
