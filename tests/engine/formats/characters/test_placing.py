from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engine.character import Character, bundled
from engine.errors import EditError
from engine.formats.characters.placing import place_rest
from engine.formats.markers import layout as markers_layout
from engine.spacetime.layout import standard

BY_HAND = ("nose_tip", "chin", "brow_outer_left", "mouth_right")


def _other(character: Character) -> Character:
    """The same head half as large again, turned to its side and elsewhere."""
    turn = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]], np.float32)
    return replace(character, neutral=1.5 * character.neutral @ turn + np.float32(40))


def test_a_head_of_the_same_form_gets_exactly_the_same_vertices() -> None:
    layout = standard(bundled())
    vertices = dict(zip(layout.names, layout.vertices.tolist(), strict=True))
    given = {name: vertices[name] for name in BY_HAND}
    assert place_rest(layout.rest(bundled()), layout.names, _other(bundled()), given) == vertices


def test_what_was_placed_by_hand_stays_and_draws_its_neighbours_along() -> None:
    layout, head = standard(bundled()), bundled()
    vertices = dict(zip(layout.names, layout.vertices.tolist(), strict=True))
    given = {name: vertices[name] for name in (*BY_HAND, "forehead", "jaw_left")}
    moved = vertices["mouth_side_left"]
    placed = place_rest(layout.rest(head), layout.names, head, {**given, "mouth_left": moved})
    assert placed["mouth_left"] == moved and all(placed[name] == vertex for name, vertex in given.items())
    assert len(set(placed.values())) == len(placed)
    side = head.neutral[[vertices["lip_upper_left"], placed["lip_upper_left"]], 0]
    assert side[1] > side[0]


@pytest.mark.parametrize(
    ("names", "says"),
    [
        (("nose_tip", "chin", "mouth_left"), "3 markers placed by hand"),
        (("nose_tip", "nose_bridge", "chin", "forehead"), "plane"),
    ],
)
def test_too_few_or_flat_markers_are_named(names: tuple[str, ...], says: str) -> None:
    layout = standard(bundled())
    given = {name: int(layout.vertices[layout.names.index(name)]) for name in names}
    points = layout.rest(bundled())
    points[[layout.names.index(name) for name in names], 0] = 0.0
    with pytest.raises(EditError, match=says):
        place_rest(points, layout.names, bundled(), given)


def test_a_landmark_file_is_read_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "landmarks.csv"
    places = {"nose_tip": 4, "brow, left": 0}
    markers_layout.write(places, path, head=bundled())
    assert markers_layout.read(path, head=bundled()) == places
