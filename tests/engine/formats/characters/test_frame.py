"""Unit and axes by the face, whatever stands around it and however it is turned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from engine.character import bundled
from engine.errors import FormatError
from engine.formats.characters.assemble import assemble
from engine.formats.characters.frame import UNITS_MM, UPS, Frame, detect
from engine.formats.characters.names import match_names
from engine.formats.characters.raw import RawCharacter
from engine.formats.characters.reading import Reading, assembled
from engine.take import SHAPES

FEW = ("jawOpen", "eyeBlinkLeft", "eyeBlinkRight", "mouthLeft")
TURNS = (0.0, 45.0, 90.0, 135.0, 180.0, -45.0, -90.0, -135.0)


def own(*names: str) -> RawCharacter:
    head = bundled()
    shapes = {name: head.deltas[SHAPES.index(name)] for name in names or SHAPES}
    return RawCharacter("own", head.neutral.astype(float), head.triangles, shapes)


def with_more(raw: RawCharacter, points: np.ndarray) -> RawCharacter:
    """Add vertices that belong to no face of the head: a body, a hat."""
    count = len(raw.vertices)
    more = np.array([[i, i + 1, i + 2] for i in range(len(points) - 2)], np.int32) + count
    still = np.zeros((len(points), 3), np.float32)
    return replace(
        raw,
        vertices=np.concatenate([raw.vertices, points]),
        triangles=np.concatenate([raw.triangles, more]),
        shapes={name: np.concatenate([delta, still]) for name, delta in raw.shapes.items()},
    )


def on_a_body(raw: RawCharacter) -> RawCharacter:
    foot, neck = raw.vertices[:, 1].min() - 1500, raw.vertices[:, 1].min() - 10
    corners = [[x, y, z] for x in (-250, 250) for y in (foot, neck) for z in (-120, 120)]
    return with_more(raw, np.array(corners, float))


def with_a_hat(raw: RawCharacter) -> RawCharacter:
    around, crown = np.linspace(0, 2 * np.pi, 40), raw.vertices[:, 1].max()
    rings = [
        np.stack([wide * np.sin(around), np.full(40, crown + high), wide * np.cos(around)], axis=1)
        for wide, high in ((250, -40), (110, -30), (110, 250))
    ]
    return with_more(raw, np.concatenate(rings))


def mask(raw: RawCharacter) -> RawCharacter:
    """Keep only what the shapes move."""
    kept = np.max([np.abs(delta).max(axis=1) for delta in raw.shapes.values()], axis=0) > 0.01
    number = np.cumsum(kept) - 1
    triangles = number[raw.triangles[kept[raw.triangles].all(axis=1)]].astype(np.int32)
    shapes = {name: delta[kept] for name, delta in raw.shapes.items()}
    return replace(raw, vertices=raw.vertices[kept], triangles=triangles, shapes=shapes)


def seen_as(raw: RawCharacter, frame: Frame) -> RawCharacter:
    """Write a head of our frame as a program with another one would have."""
    back = np.linalg.inv(frame.matrix)
    shapes = {name: (delta @ back).astype(np.float32) for name, delta in raw.shapes.items()}
    return replace(raw, vertices=raw.vertices @ back, shapes=shapes)


VARIANTS: dict[str, Callable[[], RawCharacter]] = {
    "a head": own,
    "on a body": lambda: on_a_body(own()),
    "with a hat": lambda: with_a_hat(own()),
    "a mask": lambda: mask(own()),
    "four shapes": lambda: own(*FEW),
    "four shapes on a body": lambda: on_a_body(own(*FEW)),
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_unit_and_axes_are_told_by_the_face(variant: str) -> None:
    raw = VARIANTS[variant]()
    for number, up in enumerate(UPS):
        for step, turn in enumerate(TURNS):
            frame = Frame(list(UNITS_MM)[(number + step) % 4], up, turn)
            found = detect(seen_as(raw, frame), match_names(raw.shapes))
            assert found.frame == frame and not found.exchanged


@pytest.mark.parametrize("body", [False, True])
@pytest.mark.parametrize(("up", "turn"), [("y", 0.0), ("z", 0.0), ("z", 90.0), ("y", 180.0), ("z", 45.0)])
def test_a_mesh_without_shapes_is_told_by_its_eyeballs(up: str, turn: float, body: bool) -> None:
    for unit in UNITS_MM:
        frame = Frame(unit, up, turn)
        raw = replace(own(), shapes={})
        assert detect(seen_as(on_a_body(raw) if body else raw, frame), []).frame == frame


def test_one_shape_alone_tells_a_quarter_turn() -> None:
    for up, turn in (("y", 0.0), ("z", 0.0), ("z", 180.0), ("y", 90.0)):
        frame = Frame("cm", up, turn)
        raw = own("mouthPucker")
        assert detect(seen_as(raw, frame), match_names(raw.shapes)).frame == frame


def test_sides_that_are_exchanged_do_not_turn_the_face_away_and_are_said() -> None:
    raw = own()
    swapped = {name.replace("Left", "#").replace("Right", "Left").replace("#", "Right"): d for name, d in raw.shapes.items()}
    made = assemble(replace(raw, shapes=swapped))
    assert made.frame == Frame("mm", "y")
    assert any("left shapes lie on its right" in notice for notice in made.notices)


def test_what_the_format_prescribes_is_kept_and_what_a_person_says_goes_before_it() -> None:
    raw = replace(seen_as(own(*FEW), Frame("m", "y")), unit="m", up="y")
    assert assemble(raw).frame == Frame("m", "y")
    small = replace(seen_as(own(*FEW), Frame("cm", "y")), unit="m", up="y")
    made = assembled(small, Reading(unit="cm", up="-z", facing_deg=30.0))
    assert made.frame == Frame("cm", "-z", 30.0)


@pytest.mark.parametrize(("written", "said"), [("mm", "m"), ("mm", "mm"), ("m", "mm"), ("cm", "m")])
def test_a_head_that_would_not_be_seen_is_refused_with_the_unit_that_fits(written: str, said: str) -> None:
    raw = replace(seen_as(own(*FEW), Frame(written, "y")), unit=said, up="y")
    if written == said:
        assert len(assemble(raw).character.neutral)
        return
    with pytest.raises(FormatError, match="would hardly be seen") as caught:
        assemble(raw)
    assert f"{written} would fit its face" in caught.value.advice


def test_the_axes_of_a_frame_are_a_rotation_and_named_as_a_person_would() -> None:
    for up in UPS:
        for turn in TURNS:
            axes = Frame("mm", up, turn).axes
            np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-9)
            assert np.isclose(np.linalg.det(axes), 1.0)
    assert [Frame("mm", "z", turn).facing for turn in (0, 90, 135, 30)] == ["-y", "x", "x+y", "30° to its left"]
