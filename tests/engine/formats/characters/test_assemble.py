from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from engine.character import bundled, load, save
from engine.controls import Measurer
from engine.errors import FormatError
from engine.formats.characters import read
from engine.formats.characters.assemble import Frame, assemble, detect_frame
from engine.formats.characters.raw import RawCharacter
from engine.take import SHAPE_INDEX, SHAPES

UPRIGHT = np.eye(3)
LYING = np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]])  # our rows to a frame with z up


def foreign(scale: float, turn: np.ndarray, *, shapes: bool = True) -> RawCharacter:
    """The bundled head as another program would have written it."""
    head = bundled()
    deltas = {name: head.deltas[index] * scale @ turn for index, name in enumerate(SHAPES)} if shapes else {}
    return RawCharacter("foreign", head.neutral.astype(float) * scale @ turn, head.triangles, deltas)


@pytest.mark.parametrize(("unit", "scale"), [("mm", 1.0), ("cm", 0.1), ("m", 0.001), ("in", 1 / 25.4)])
@pytest.mark.parametrize(("up", "turn"), [("y", UPRIGHT), ("z", LYING)])
def test_unit_and_upward_axis_are_found_and_undone(unit: str, scale: float, up: str, turn: np.ndarray) -> None:
    made = assemble(foreign(scale, turn))
    assert made.frame == Frame(unit, up)
    np.testing.assert_allclose(made.character.neutral, bundled().neutral, atol=1e-3)
    np.testing.assert_allclose(made.character.deltas, bundled().deltas, atol=1e-3)


def test_a_mesh_without_shapes_has_its_unit_found_by_size() -> None:
    assert detect_frame(foreign(0.1, UPRIGHT, shapes=False)) == Frame("cm", "y")


def test_landmarks_of_the_same_head_come_back() -> None:
    head = bundled()
    found = assemble(foreign(0.1, UPRIGHT)).character.landmarks
    for name, vertex in head.landmarks.items():
        assert np.linalg.norm(head.neutral[found[name]] - head.neutral[vertex]) < 1.0, name


def test_a_landmark_placed_by_hand_stays_and_one_outside_is_refused() -> None:
    assert assemble(foreign(1.0, UPRIGHT), landmarks={"chin": 7}).character.landmarks["chin"] == 7
    with pytest.raises(FormatError, match="'chin' names vertex"):
        assemble(foreign(1.0, UPRIGHT), landmarks={"chin": 10**6})


def test_what_was_guessed_is_said() -> None:
    made = assemble(foreign(0.1, UPRIGHT, shapes=False))
    assert "Read in cm, y up, facing z." in made.notices
    assert any("no shapes" in notice for notice in made.notices)


def test_the_second_head_is_imported_as_a_new_user_would(real_take_path: Path, tmp_path: Path) -> None:
    packed = real_take_path.parent.parent / "ict_facekit" / "ict_facekit.npz"
    if not packed.exists():
        pytest.skip(f"needs the second head in {os.environ.get('RETAKE_DATA', 'the recorded data')}")
    made = assemble(read(packed))
    assert made.frame == Frame("cm", "y")
    assert {row.source for row in made.matches if not row.shape} == {
        "PupilDilate_L", "PupilDilate_R", "cheekRaiser_L", "cheekRaiser_R",
    }  # fmt: skip
    save(made.character, tmp_path / "ict.npz")
    measurer = Measurer(load(tmp_path / "ict.npz"))
    rest, jaw, blink = np.zeros((3, len(SHAPES)))
    jaw[SHAPE_INDEX["jawOpen"]] = blink[SHAPE_INDEX["eyeBlinkLeft"]] = 1
    lips, _, _, eye = measurer.measure(np.stack([rest, jaw, blink]))[:, :4].T
    assert lips[1] - lips[0] > 20 and eye[2] < 0.5 * eye[0] and np.isclose(lips[2], lips[0], atol=0.01)
