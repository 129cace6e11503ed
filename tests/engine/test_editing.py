from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine import editing
from engine.controls import ALL_CONTROLS, ALL_INDEX, CONTROL_INDEX, CONTROLS, measure
from engine.editing import ControlRequest, Dragger, ask, parse_frames, set_control
from engine.errors import EditError
from engine.extended import bundled_face
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.regress.plausibility import DEFAULT_BELIEVABILITY
from engine.regress.prior import bundled_prior
from engine.take import SHAPE_INDEX, SHAPES, Take

LIPS = CONTROL_INDEX["lips_vertical"]
measure_all = bundled_face().measure


@pytest.fixture(scope="module")
def demo_take() -> Take:
    return read_take(demo.BUNDLED)


def test_closing_the_lips_of_a_real_take(real_take_path: Path, tmp_path: Path) -> None:
    take = read_take(real_take_path)
    patch = set_control(take, ControlRequest("lips_vertical", (1600, 1620), "set", 0.0))
    edited = patch.apply(take)
    assert measure(edited.weights)[1600:1620, LIPS].max() <= 2.0
    assert edited.weights[1605:1615, SHAPE_INDEX["jawOpen"]].max() < 0.25 < take.weights[1605, SHAPE_INDEX["jawOpen"]]
    outside = np.r_[0 : patch.start, patch.stop : len(take)]
    np.testing.assert_array_equal(edited.weights[outside], take.weights[outside])
    assert len(outside) >= len(take) - 60
    write_take(edited, tmp_path / "edited.csv")
    np.testing.assert_allclose(read_take(tmp_path / "edited.csv").weights, edited.weights, atol=1e-8)


def test_asking_for_what_is_there_changes_nothing(demo_take: Take) -> None:
    dragger = Dragger(demo_take)
    patch = dragger.drag(100, dragger.controls[100:120])
    np.testing.assert_array_equal(patch.weights, demo_take.weights[patch.start : patch.stop])


@pytest.mark.parametrize("believability", [0.0, DEFAULT_BELIEVABILITY])
def test_the_asked_curve_is_landed_on(demo_take: Take, believability: float) -> None:
    dragger = Dragger(demo_take)
    start, asked = ask(dragger.controls, "lips_vertical", (60, 80), "set", 9.0, fps=demo_take.fps)
    patch = dragger.drag(start, asked, believability=believability)
    np.testing.assert_allclose(patch.reached[60 - patch.start : 80 - patch.start, LIPS], 9.0, atol=1e-3)


def test_curves_without_the_extended_ones_are_curves(demo_take: Take) -> None:
    dragger = Dragger(demo_take)
    start, asked = ask(dragger.controls, "lips_vertical", (60, 80), "add", 3.0, fps=demo_take.fps)
    np.testing.assert_array_equal(
        dragger.drag(start, asked[:, : len(CONTROLS)]).weights, dragger.drag(start, asked).weights
    )


def test_a_change_is_kept_beside_its_frames_where_it_is_there_already(demo_take: Take) -> None:
    curves = measure_all(demo_take.weights)
    start, once = ask(curves, "lips_vertical", (60, 80), "set", 9.0, fps=30.0)
    curves = curves.copy()
    curves[start : start + len(once)] = once
    np.testing.assert_array_equal(ask(curves, "lips_vertical", (60, 80), "set", 9.0, fps=30.0)[1], once)


def test_what_a_take_does_itself_may_be_beyond_everyone(demo_take: Take) -> None:
    """A take further out than any recording plays back, and an edit of it moves the face from where it is."""
    wild = np.array(demo_take.weights)
    wild[:, SHAPE_INDEX["jawOpen"]] = 1.0
    wild[:, SHAPE_INDEX["mouthFunnel"]] = 1.0
    dragger = Dragger(Take(weights=wild, fps=demo_take.fps))
    assert (dragger.controls[:, LIPS] > bundled_prior().high[LIPS]).any()
    patch = dragger.drag(*ask(dragger.controls, "lips_vertical", (60, 80), "add", -6.0, fps=demo_take.fps))
    moved = patch.reached[60 - patch.start : 80 - patch.start, LIPS] - dragger.controls[60:80, LIPS]
    assert (moved < -2.0).all()


def test_contacts_take_hold_without_a_pop(demo_take: Take) -> None:
    """Reached distance as a function of the asked one has no jump on the way to a contact."""
    dragger = Dragger(demo_take)
    values = np.linspace(8.0, 0.0, 41)
    reached = [
        dragger.drag(*ask(dragger.controls, "lips_vertical", (60, 80), "set", value, fps=demo_take.fps))
        .reached[:, LIPS]
        .min()
        for value in values
    ]
    assert reached[-1] < 0.5
    assert np.abs(np.diff(reached)).max() < 1.0


@pytest.mark.parametrize("text", ["", "5", "60:40", "-1:5", "0:100000", "a:b"])
def test_a_range_outside_the_take_is_refused(demo_take: Take, text: str) -> None:
    with pytest.raises(EditError):
        parse_frames(text, demo_take)


def test_a_take_of_one_frame_can_be_edited() -> None:
    take = Take(weights=np.zeros((1, 52)), fps=30.0)
    patch = set_control(take, ControlRequest("lips_vertical", (0, 1), "add", 8.0))
    assert patch.reached[0, LIPS] > 3.0
    assert patch.apply(take).weights.shape == (1, 52)


def test_a_change_must_be_finite(demo_take: Take) -> None:
    with pytest.raises(EditError):
        editing.ask(measure_all(demo_take.weights), "lips_vertical", (0, 5), "set", float("nan"), fps=30.0)


def test_a_wink_leaves_the_other_eye_bit_for_bit(demo_take: Take) -> None:
    patch = set_control(demo_take, ControlRequest("eyelid_right", (60, 66), "set", 0.0))
    left = [index for index, name in enumerate(SHAPES) if name.startswith("eye") and name.endswith("Left")]
    np.testing.assert_array_equal(patch.weights[:, left], demo_take.weights[patch.start : patch.stop, left])
    assert patch.reached[60 - patch.start : 66 - patch.start, CONTROL_INDEX["eyelid_right"]].max() < 1.0


def test_what_an_edit_before_asked_for_is_not_undone(demo_take: Take) -> None:
    """Both curves are met, though the second drag alone would move the first."""
    width = ALL_INDEX["lips_horizontal"]
    first = Dragger(demo_take)
    start, wide = ask(first.controls, "lips_horizontal", (60, 80), "add", 4.0, fps=demo_take.fps)
    patch = first.drag(start, wide)
    asked = np.full_like(first.controls, np.nan)
    asked[start : start + len(wide), width] = wide[:, width]
    second = Dragger(patch.apply(demo_take), asked=asked)
    start, apart = ask(second.controls, "lips_vertical", (60, 80), "add", 4.0, fps=demo_take.fps)
    patch = second.drag(start, apart)
    reached = patch.reached[60 - patch.start : 80 - patch.start]
    np.testing.assert_allclose(reached[:, width], asked[60:80, width], atol=1e-3)
    np.testing.assert_allclose(reached[:, LIPS], apart[60 - start : 80 - start, LIPS], atol=2e-3)


def test_two_curves_asked_over_other_frames_leave_no_notch(demo_take: Take) -> None:
    """Where one of them ends under the other, the face goes on as smoothly as the take does."""
    dragger, height, lips = Dragger(demo_take), ALL_INDEX["corner_height_left"], LIPS
    wish = np.full((50, len(ALL_CONTROLS)), np.nan)
    for column, (start, stop), by in ((height, (50, 70), 2.0), (lips, (60, 85), 4.0)):
        first, curve = ask(dragger.controls, ALL_CONTROLS[column].name, (start, stop), "add", by, fps=demo_take.fps)
        wish[first - 44 : first - 44 + len(curve), column] = curve[:, column]
    edited = dragger.drag(44, wish).apply(demo_take).weights
    mouth = [index for index, name in enumerate(SHAPES) if name.startswith(("jaw", "mouth"))]
    before, after = (np.abs(np.diff(each[:, mouth], n=2, axis=0)).max(axis=1) for each in (demo_take.weights, edited))
    assert (after <= np.maximum(before, np.quantile(before, 0.99)) + 0.02).all()


def test_extended_controls_have_their_own_shapes(demo_take: Take) -> None:
    for control, prefix in (("brow_inner", "brow"), ("gaze_vertical", "eyeLook"), ("jaw_sideways", ("jaw", "mouth"))):
        patch = set_control(demo_take, ControlRequest(control, (60, 80), "add", 1.0))
        moved = (patch.weights != demo_take.weights[patch.start : patch.stop]).any(axis=0)
        assert moved.any() and all(SHAPES[index].startswith(prefix) for index in np.flatnonzero(moved))


def test_closed_lips_stay_closed_while_their_corners_move() -> None:
    take = Take(weights=np.zeros((90, 52)), fps=30.0)
    for control, amount in (("lips_horizontal", -4.0), ("corner_left", 4.0)):
        patch = set_control(take, ControlRequest(control, (30, 60), "add", amount))
        assert patch.reached[:, LIPS].max() < 1.0
