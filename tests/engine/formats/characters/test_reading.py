from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from engine.character import bundled
from engine.errors import EditError
from engine.formats.characters.raw import RawCharacter
from engine.formats.characters.reading import Reading, assembled, import_head
from engine.take import SHAPE_INDEX, SHAPES
from tests.heads import write_glb

FULL = Reading("cm", "z", 12.5, {"a": "jawOpen", "b": ""})


def raw(scale: float = 1.0) -> RawCharacter:
    head = bundled()
    shapes = {name: head.deltas[at] * np.float32(scale) for name, at in SHAPE_INDEX.items()}
    return RawCharacter("a", head.neutral.astype(float) * scale, head.triangles, shapes)


def test_corrections_come_back_from_what_json_holds() -> None:
    for reading in (FULL, Reading(), Reading(up="z"), Reading(facing_deg=0.0)):
        assert Reading.restored(json.loads(json.dumps(reading.stored()))) == reading
    assert Reading().stored() == {} and Reading(facing_deg=0.0).stored() == {"facing_deg": 0.0}


@pytest.mark.parametrize(
    "stored", [None, [], 7, {"unit": 3, "up": None, "facing_deg": "x", "names": [1]}, {"unit": []}]
)
def test_what_a_damaged_project_holds_is_detected_anew(stored: object) -> None:
    assert Reading.restored(stored) == Reading()
    assert Reading.restored({"names": {1: 2}, "facing_deg": 3}) == Reading(names={"1": "2"}, facing_deg=3.0)


@pytest.mark.parametrize(
    ("reading", "says"),
    [
        (Reading("furlong"), "no unit called 'furlong'"),
        (Reading(up="w"), "no upward axis called 'w'"),
        (Reading(facing_deg=360.1), "turned by -360 to 360 degrees"),
        (Reading(facing_deg=float("nan")), "turned by"),
        (Reading(names={"nose": "jawOpen"}), "no shape called 'nose'"),
    ],
)
def test_a_correction_that_cannot_be_is_a_sentence(reading: Reading, says: str) -> None:
    with pytest.raises(EditError, match=says):
        assembled(raw(), reading)


def test_a_corrected_unit_and_turn_are_taken_in_place_of_what_was_detected() -> None:
    plain = assembled(raw(), Reading()).character
    smaller = assembled(raw(0.1), Reading(unit="mm")).character
    np.testing.assert_allclose(smaller.neutral, assembled(raw(0.1), Reading()).character.neutral / 10, atol=1e-3)
    turned = assembled(raw(), Reading(facing_deg=360.0)).character
    np.testing.assert_allclose(turned.neutral, plain.neutral, atol=1e-3)
    assert assembled(raw(), Reading(names={"jawOpen": ""})).character.lacking == ("jawOpen",)


def test_a_head_is_imported_with_landmarks_by_hand(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "a.glb", {name: name for name in SHAPES})
    found = import_head(path, landmarks={"chin": 7})
    assert found.character.landmarks["chin"] == 7
