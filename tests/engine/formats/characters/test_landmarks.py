from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.character import Character, bundled
from engine.errors import EditError
from engine.formats.characters.landmarks import with_landmarks


def plain(matrix: np.ndarray) -> Character:
    """The bundled head without its shapes and landmarks, changed by a matrix."""
    head = bundled()
    changed = (head.neutral @ matrix.T).astype(np.float32)
    return replace(head, neutral=changed, deltas=np.zeros_like(head.deltas), landmarks={})


def away(found: Character) -> dict[str, float]:
    """Return how far each landmark is from where it belongs, mm."""
    places = {name: found.neutral[vertex] for name, vertex in bundled().landmarks.items()}
    return {name: float(np.linalg.norm(found.neutral[found.landmarks[name]] - place)) for name, place in places.items()}


def test_a_head_without_shapes_has_its_landmarks_found_by_its_form() -> None:
    found, _ = with_landmarks(plain(1.1 * np.eye(3)))
    assert set(found.landmarks) == set(bundled().landmarks)
    assert np.mean(list(away(found).values())) < 3


def test_landmarks_placed_by_hand_stay_and_lead_those_near_them() -> None:
    head = plain(np.diag([1.15, 0.85, 1.1]))  # broad and short: no turn and size lays one head on the other
    alone, _ = with_landmarks(head)
    corners = {name: bundled().landmarks[name] for name in ("mouth_left", "mouth_right", "lip_upper", "chin")}
    led, away_mm = with_landmarks(head, corners)
    assert corners.items() <= led.landmarks.items() and all(away_mm[name] == 0 for name in corners)
    others = [name for name in bundled().landmarks if "lip" in name and name not in corners]
    assert np.mean([away(led)[name] for name in others]) <= np.mean([away(alone)[name] for name in others])


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"ear": 3}, "no landmark called 'ear'"),
        ({"chin": -1}, "names vertex -1"),
        ({"chin": 10**6}, "names vertex 1000"),
    ],
)
def test_what_cannot_be_placed_is_named(given: dict[str, int], says: str) -> None:
    with pytest.raises(EditError, match=says):
        with_landmarks(bundled(), given)
