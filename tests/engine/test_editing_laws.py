"""Laws that a hand expects of every edit: what is asked is what comes, whoever asks, wherever, however often."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from engine.controls import ALL_CONTROLS, ALL_INDEX
from engine.editing import ControlRequest, Dragger, Patch, ask, set_control
from engine.extended import bundled_face
from engine.formats import read_take
from engine.lab.performer import demo
from engine.lab.performer.augment import MIRROR
from engine.regress.prior import MIRROR_CONTROL, MIRROR_SIGN
from engine.take import SHAPES, Array, Take

DEMO = read_take(demo.BUNDLED)
# What a small pull is for each control, in its unit.
SMALL = {control.name: 5.0 if control.unit == "degrees" else 1.0 for control in ALL_CONTROLS}
TINY = 0.003  # of a weight: .05 mm of skin at most; where lips nearly meet, edits so small differ by so much
MOUTH = np.array([name.startswith(("jaw", "mouth", "cheek", "nose", "tongue")) for name in SHAPES])

controls = st.sampled_from([control.name for control in ALL_CONTROLS])
pulls = st.floats(-2.0, 2.0).filter(lambda share: abs(share) > 0.1)
places = st.integers(20, 100)
law = settings(max_examples=12, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


def pull(take: Take, control: str, by: float, start: int, frames: int = 24) -> Patch:
    return set_control(take, ControlRequest(control, (start, start + frames), "add", by * SMALL[control]))


def curve(weights: Array, control: str) -> Array:
    return np.asarray(bundled_face().measure(weights)[:, ALL_INDEX[control]])


# A quarter as fast, so that it is the same between its frames at any rate.
SLOW = Take(weights=CubicSpline(np.arange(len(DEMO)), DEMO.weights)(np.arange(0, len(DEMO) - 1, 1 / 16)), fps=120.0)


@law
@given(start=places)
def test_nothing_asked_nothing_moved(start: int) -> None:
    dragger = Dragger(DEMO)
    patch = dragger.drag(start, dragger.controls[start : start + 30])
    np.testing.assert_array_equal(patch.weights, DEMO.weights[patch.start : patch.stop])


@pytest.mark.parametrize("control", ALL_INDEX)
@law
@given(by=pulls, start=places)
def test_a_small_pull_is_reached(control: str, by: float, start: int) -> None:
    """As far as the take or the recordings go there: what was granted is met, and small pulls are granted."""
    if control.startswith("eyelid") and by < 0:
        return  # lids that are shut do not shut further
    patch = pull(DEMO, control, by, start)
    inside = slice(start - patch.start, start - patch.start + 24)
    column = ALL_INDEX[control]
    change = np.abs(patch.asked - bundled_face().measure(DEMO.weights[patch.start : patch.stop]))[inside, column]
    missed = np.abs(patch.asked - patch.reached)[inside, column]
    assert missed.mean() <= 0.03 * change.mean() + 0.02


@law
@given(control=controls, by=pulls, start=places)
def test_asking_twice_is_asking_once(control: str, by: float, start: int) -> None:
    value = float(curve(DEMO.weights, control)[start : start + 24].mean() + by * SMALL[control])
    once = set_control(DEMO, ControlRequest(control, (start, start + 24), "set", max(0.0, value))).apply(DEMO)
    twice = set_control(once, ControlRequest(control, (start, start + 24), "set", max(0.0, value))).apply(once)
    np.testing.assert_allclose(curve(twice.weights, control), curve(once.weights, control), rtol=0, atol=0.05)


@law
@given(control=controls, by=pulls, start=places)
def test_dragging_back_brings_back(control: str, by: float, start: int) -> None:
    """The curve on the edited take; and bit for bit where it is one wish, asked of the take below."""
    patch = pull(DEMO, control, by, start)
    edited = patch.apply(DEMO)
    before = curve(DEMO.weights, control)
    wish = Dragger(edited).controls[patch.start : patch.stop].copy()
    wish[:, ALL_INDEX[control]] = before[patch.start : patch.stop]
    back = Dragger(edited).drag(patch.start, wish).apply(edited)
    inside = slice(start, start + 24)
    assert np.abs(curve(back.weights, control) - before)[inside].mean() <= 0.1
    dragger = Dragger(DEMO)
    dragger.drag(patch.start, patch.asked)
    again = dragger.drag(patch.start, dragger.controls[patch.start : patch.stop])
    np.testing.assert_array_equal(again.weights, DEMO.weights[again.start : again.stop])


@law
@given(control=controls, by=pulls, start=places)
def test_a_mirrored_take_is_edited_mirrored(control: str, by: float, start: int) -> None:
    index = ALL_INDEX[control]
    other = ALL_CONTROLS[MIRROR_CONTROL[index]].name
    there = DEMO.with_weights(DEMO.weights[:, MIRROR])
    patch, mirrored = pull(DEMO, control, by, start), pull(there, other, MIRROR_SIGN[index] * by, start)
    np.testing.assert_allclose(mirrored.weights[:, MIRROR], patch.weights, rtol=0, atol=1e-6)


@pytest.mark.parametrize("fps", [24.0, 30.0, 60.0])
@law
@given(control=controls, by=pulls, start=st.integers(6, 24))
def test_an_edit_is_the_same_at_any_rate(fps: float, control: str, by: float, start: int) -> None:
    """As at 120 fps, within .03 of the edit's largest change of a weight, or `TINY` of small edits."""
    smooth, frames = SLOW, (start * 20, start * 20 + 100)
    fine = set_control(smooth, ControlRequest(control, frames, "add", by * SMALL[control])).apply(smooth)
    step = round(120 / fps)
    coarse = Take(weights=smooth.weights[::step], fps=fps)
    seen = set_control(
        coarse, ControlRequest(control, (frames[0] // step, frames[1] // step), "add", by * SMALL[control])
    )
    moved = np.abs(fine.weights - smooth.weights).max()
    assert np.abs(seen.apply(coarse).weights - fine.weights[::step]).max() <= max(0.03 * moved, TINY)


@law
@given(control=controls, by=pulls, start=places, cut=st.integers(1, 18))
def test_cropping_a_take_does_not_change_an_edit(control: str, by: float, start: int, cut: int) -> None:
    cropped = Take(weights=DEMO.weights[cut:], fps=DEMO.fps)
    whole, part = pull(DEMO, control, by / 4, start + cut), pull(cropped, control, by / 4, start)
    assert part.start == whole.start - cut
    np.testing.assert_array_equal(part.weights, whole.weights)


@law
@given(control=controls, second=controls, by=pulls, then=pulls)
def test_edits_apart_commute(control: str, second: str, by: float, then: float) -> None:
    def both(*order: tuple[str, float, int]) -> Array:
        take = DEMO
        for name, amount, start in order:
            take = pull(take, name, amount / 4, start).apply(take)
        return np.asarray(take.weights)

    one, other = (control, by, 30), (second, then, 90)
    np.testing.assert_array_equal(both(one, other), both(other, one))


@law
@given(control=controls, sign=st.sampled_from([-1.0, 1.0]), start=places)
def test_asking_more_never_gives_less(control: str, sign: float, start: int) -> None:
    """But for lips that meet: their points pass each other by less than a tenth of a millimetre."""
    dragger = Dragger(DEMO)
    reached = []
    for by in (0.25, 0.5, 1.0, 2.0, 3.0, 6.0):
        wish = ask(dragger.controls, control, (start, start + 24), "add", sign * by * SMALL[control], fps=DEMO.fps)
        patch = dragger.drag(*wish)
        reached.append(patch.reached[start - patch.start :][:24, ALL_INDEX[control]])
    meeting = control == "lips_vertical" and sign < 0
    assert (sign * np.diff(reached, axis=0)).min() >= (-0.1 if meeting else -0.01)


@law
@given(
    control=st.sampled_from(["brow_right", "brow_inner", "gaze_horizontal", "gaze_vertical"]), by=pulls, start=places
)
def test_the_mouth_stays_under_brows_and_gaze(control: str, by: float, start: int) -> None:
    patch = pull(DEMO, control, by, start)
    np.testing.assert_array_equal(patch.weights[:, MOUTH], DEMO.weights[patch.start : patch.stop][:, MOUTH])
    assert (patch.weights != DEMO.weights[patch.start : patch.stop]).any()


@law
@given(side=st.sampled_from(["right", "left"]), by=pulls, start=places)
def test_one_eye_leaves_the_other_alone(side: str, by: float, start: int) -> None:
    other = "Left" if side == "right" else "Right"
    patch = pull(DEMO, f"eyelid_{side}", by, start)
    still = np.array([name.startswith("eye") and name.endswith(other) for name in SHAPES])
    np.testing.assert_array_equal(patch.weights[:, still], DEMO.weights[patch.start : patch.stop][:, still])
