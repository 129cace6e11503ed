from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine import editing
from engine.controls import CONTROL_INDEX, measure
from engine.editing import Dragger, ask, edit_control, parse_frames
from engine.errors import EditError
from engine.formats import read_take, write_take
from engine.models.resample import interpolate
from engine.performance import demo
from engine.regress import infer
from engine.take import SHAPE_INDEX, SHAPES, Take

LIPS = CONTROL_INDEX["lips_vertical"]


@pytest.fixture(scope="module")
def demo_take() -> Take:
    return read_take(demo.BUNDLED)


def test_closing_the_lips_of_a_real_take(real_take_path: Path, tmp_path: Path) -> None:
    take = read_take(real_take_path)
    patch = edit_control(take, "lips_vertical", (1600, 1620), "set", 0.0)
    edited = patch.apply(take)
    assert measure(edited.weights)[1600:1620, LIPS].max() <= 2.0
    assert edited.weights[1605:1615, SHAPE_INDEX["jawOpen"]].max() < 0.15 < take.weights[1605, SHAPE_INDEX["jawOpen"]]
    outside = np.r_[0 : patch.start, patch.stop : len(take)]
    np.testing.assert_array_equal(edited.weights[outside], take.weights[outside])
    assert len(outside) >= len(take) - 60
    write_take(edited, tmp_path / "edited.csv")
    np.testing.assert_allclose(read_take(tmp_path / "edited.csv").weights, edited.weights, atol=1e-8)


@pytest.mark.parametrize("fps", [24.0, 30.0, 59.94, 120.0])
def test_a_patch_equals_inference_over_the_whole_take(demo_take: Take, fps: float) -> None:
    """The window is only a short cut: N(asked) - N(original) over the whole take gives the same weights."""
    frames = int((len(demo_take) - 1) * fps / 30) + 1
    take = Take(weights=interpolate(demo_take.weights, np.arange(frames) * 30 / fps), fps=fps)
    dragger = Dragger(take)
    start = frames // 2
    asked = dragger.controls[start : start + 30].copy()
    asked[:, LIPS] = asked[:, LIPS] + 6.0
    patch = dragger.drag(start, asked, follow=False)

    wanted = dragger.controls.copy()
    wanted[start : start + 30] = asked
    at = np.arange(int(np.ceil((frames - 1) * 30 / fps)) + 1) * fps / 30
    network, original = infer.bundled(), interpolate(dragger.controls, at)
    change = network.infer(interpolate(wanted, at), original=original) - network.infer(original, original=original)
    whole = take.weights + interpolate(change, np.arange(frames) * 30 / fps)
    expected = np.clip(whole, np.minimum(take.weights, 0), np.maximum(take.weights, 1))
    np.testing.assert_allclose(
        patch.weights[start - patch.start :][:30], expected[start : start + 30], rtol=0, atol=1e-5
    )


def test_asking_for_what_is_there_changes_nothing(demo_take: Take) -> None:
    dragger = Dragger(demo_take)
    patch = dragger.drag(100, dragger.controls[100:120])
    np.testing.assert_array_equal(patch.weights, demo_take.weights[patch.start : patch.stop])


def test_exact_lands_on_the_asked_curve(demo_take: Take) -> None:
    dragger = Dragger(demo_take)
    start, asked = ask(dragger.controls, "lips_vertical", (60, 80), "set", 9.0)
    patch = dragger.drag(start, asked, exact_curve=True)
    np.testing.assert_allclose(patch.reached[60 - patch.start : 80 - patch.start, LIPS], 9.0, atol=0.05)


def test_asking_for_more_than_anyone_did_brings_the_face_back_no_more(demo_take: Take) -> None:
    dragger = Dragger(demo_take)
    column = CONTROL_INDEX["lips_horizontal"]
    narrow = [
        dragger.drag(*ask(dragger.controls, "lips_horizontal", (60, 80), "add", by_mm)).reached[20:30, column]
        for by_mm in (-15.0, -25.0, -40.0)
    ]
    np.testing.assert_allclose(narrow[1:], [narrow[0]] * 2, atol=0.1)
    low, high = infer.bundled().limits
    assert (low < high).all() and np.isfinite([low, high]).all()


def test_what_a_take_does_itself_may_be_beyond_everyone(demo_take: Take) -> None:
    """A take further out than any recording plays back, and an edit of it moves the face from where it is."""
    wild = np.array(demo_take.weights)
    wild[:, SHAPE_INDEX["jawOpen"]] = 1.0
    wild[:, SHAPE_INDEX["mouthFunnel"]] = 1.0
    dragger = Dragger(Take(weights=wild, fps=demo_take.fps))
    assert (dragger.controls[:, LIPS] > infer.bundled().limits[1][LIPS]).any()
    patch = dragger.drag(*ask(dragger.controls, "lips_vertical", (60, 80), "add", -6.0))
    moved = patch.reached[60 - patch.start : 80 - patch.start, LIPS] - dragger.controls[60:80, LIPS]
    assert (moved < -2.0).all()


def test_contacts_take_hold_without_a_pop(demo_take: Take) -> None:
    """Reached distance as a function of the asked one has no jump on the way to a contact."""
    dragger = Dragger(demo_take)
    values = np.linspace(8.0, 0.0, 41)
    reached = [
        dragger.drag(*ask(dragger.controls, "lips_vertical", (60, 80), "set", value)).reached[:, LIPS].min()
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
    patch = edit_control(take, "lips_vertical", (0, 1), "add", 8.0)
    assert patch.reached[0, LIPS] > 3.0
    assert patch.apply(take).weights.shape == (1, 52)


def test_a_change_must_be_finite(demo_take: Take) -> None:
    with pytest.raises(EditError):
        editing.ask(measure(demo_take.weights), "lips_vertical", (0, 5), "set", float("nan"))


def test_a_wink_leaves_the_other_eye_bit_for_bit(demo_take: Take) -> None:
    patch = edit_control(demo_take, "eyelid_right", (60, 66), "set", 0.0)
    left = [index for index, name in enumerate(SHAPES) if name.startswith("eye") and name.endswith("Left")]
    np.testing.assert_array_equal(patch.weights[:, left], demo_take.weights[patch.start : patch.stop, left])
    assert patch.reached[60 - patch.start : 66 - patch.start, CONTROL_INDEX["eyelid_right"]].max() < 1.0


def test_the_rest_that_follows_lets_a_drag_get_further(demo_take: Take) -> None:
    missed = {}
    for follow in (False, True):
        patch = edit_control(demo_take, "lips_horizontal", (60, 80), "add", 5.0, follow=follow)
        column = CONTROL_INDEX["lips_horizontal"]
        missed[follow] = np.abs(patch.asked - patch.reached)[60 - patch.start : 80 - patch.start, column].mean()
    assert missed[True] < 0.7 * missed[False]
    assert missed[True] == pytest.approx(
        np.abs((default := edit_control(demo_take, "lips_horizontal", (60, 80), "add", 5.0)).asked - default.reached)[
            60 - default.start : 80 - default.start, CONTROL_INDEX["lips_horizontal"]
        ].mean()
    )


def test_what_an_edit_before_asked_for_is_not_undone(demo_take: Take) -> None:
    """Exactly: both curves are met, though the second drag alone would move the first."""
    first = Dragger(demo_take)
    start, wide = ask(first.controls, "lips_horizontal", (60, 80), "add", 4.0)
    patch = first.drag(start, wide, exact_curve=True)
    asked = np.full_like(first.controls, np.nan)
    asked[start : start + len(wide), CONTROL_INDEX["lips_horizontal"]] = wide[:, CONTROL_INDEX["lips_horizontal"]]
    second = Dragger(patch.apply(demo_take), asked=asked)
    start, apart = ask(second.controls, "lips_vertical", (60, 80), "add", 4.0)
    patch = second.drag(start, apart, exact_curve=True)
    reached = patch.reached[60 - patch.start : 80 - patch.start]
    width = CONTROL_INDEX["lips_horizontal"]
    np.testing.assert_allclose(reached[:, width], asked[60:80, width], atol=0.05)
    np.testing.assert_allclose(reached[:, LIPS], apart[60 - start : 80 - start, LIPS], atol=0.05)


def test_closed_lips_stay_closed_while_their_corners_move() -> None:
    take = Take(weights=np.zeros((90, 52)), fps=30.0)
    for control, amount in (("lips_horizontal", -4.0), ("corner_left", 4.0)):
        patch = edit_control(take, control, (30, 60), "add", amount)
        assert patch.reached[:, LIPS].max() < 1.0
