from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.controls import ALL_CONTROLS, ALL_INDEX, CONTROLS
from engine.editing.drags import EASE_S, FARTHEST_MM, Dragger, ask
from engine.errors import EditError
from engine.extended import bundled_face
from engine.take import SHAPES, Take

LIPS, SIDEWAYS = ALL_INDEX["lips_vertical"], ALL_INDEX["jaw_sideways"]


@pytest.fixture(scope="module")
def take() -> Take:
    rng = np.random.default_rng(5)
    return Take(np.clip(0.2 + np.cumsum(rng.normal(0, 0.01, (90, len(SHAPES))), axis=0), 0, 1), 30.0)


@pytest.fixture(scope="module")
def dragger(take: Take) -> Dragger:
    return Dragger(take)


def curves(frames: int = 100) -> np.ndarray:
    return 20 + 5 * np.random.default_rng(0).random((frames, len(ALL_CONTROLS)))


@pytest.mark.parametrize(("change", "amount"), [("set", 12.0), ("add", -3.0), ("scale", 0.5)])
@pytest.mark.parametrize("frames", [(40, 60), (0, 10), (95, 100), (0, 100), (99, 100)])
@pytest.mark.parametrize("fps", [30.0, 60.0])
def test_a_change_is_asked_in_full_of_its_frames_and_fades_beside_them(
    change: str, amount: float, frames: tuple[int, int], fps: float
) -> None:
    controls = curves()
    first, asked = ask(controls, "lips_vertical", frames, change, amount, fps=fps)  # type: ignore[arg-type]
    own = controls[:, LIPS]
    wanted = {"set": 0 * own + amount, "add": own + amount, "scale": own * amount}[change]
    reach = int(EASE_S * fps)
    assert (first, first + len(asked)) == (max(0, frames[0] - reach), min(100, frames[1] + reach + 1))
    for frame in range(first, first + len(asked)):
        end = min(max(frame, frames[0]), frames[1], 99)
        near = max(0.0, 1 - abs(frame - end) / (EASE_S * fps))
        share = near * near * (3 - 2 * near)
        assert asked[frame - first, LIPS] == pytest.approx(own[frame] + share * (wanted[end] - own[end]))
    others = np.delete(asked, LIPS, axis=1)
    np.testing.assert_array_equal(others, np.delete(controls[first : first + len(asked)], LIPS, axis=1))


def test_a_distance_is_asked_for_no_less_than_nothing_and_what_has_a_side_for_either() -> None:
    assert ask(curves(), "lips_vertical", (40, 50), "set", -5.0, fps=30.0)[1][:, LIPS].min() == 0.0
    assert ask(curves(), "jaw_sideways", (40, 50), "set", -5.0, fps=30.0)[1][:, SIDEWAYS].min() == -5.0


@pytest.mark.parametrize("amount", [np.nan, np.inf, -np.inf, FARTHEST_MM + 1, -FARTHEST_MM - 1])
def test_an_amount_that_no_face_could_take_is_refused(amount: float) -> None:
    with pytest.raises(EditError, match="within 1,000"):
        ask(curves(), "lips_vertical", (40, 50), "add", amount, fps=30.0)


@pytest.mark.parametrize("amount", [FARTHEST_MM, -FARTHEST_MM])
def test_the_farthest_amount_is_still_an_amount(amount: float) -> None:
    _, asked = ask(curves(), "jaw_sideways", (40, 50), "set", amount, fps=30.0)
    assert np.abs(asked[:, SIDEWAYS]).max() == FARTHEST_MM


def test_a_patch_tells_what_was_asked_what_is_granted_and_what_is_reached(take: Take, dragger: Dragger) -> None:
    np.testing.assert_array_equal(dragger.controls, bundled_face().measure(take.weights))
    asked = dragger.controls[40:50].copy()
    asked[:, LIPS] += 2.0
    patch = dragger.drag(40, asked, believability=0.0)
    assert (patch.start, patch.stop) == (34, 56)  # with 0.2 s beside
    np.testing.assert_array_equal(patch.reached, bundled_face().measure(patch.weights))
    there = np.isfinite(patch.asked)
    assert there[6:16, LIPS].all() and there.sum() == 10
    np.testing.assert_allclose(patch.asked[there], asked[:, LIPS])
    assert patch.granted is not None
    np.testing.assert_allclose(patch.granted[there], asked[:, LIPS])
    np.testing.assert_allclose(patch.reached[there], asked[:, LIPS], atol=2e-3)


def test_eight_curves_are_asked_as_sixteen_of_which_eight_are_left_alone(dragger: Dragger) -> None:
    asked = np.full((10, len(ALL_CONTROLS)), np.nan)
    asked[:, : len(CONTROLS)] = dragger.controls[40:50, : len(CONTROLS)]
    asked[:, LIPS] += 1.0
    eight, sixteen = (dragger.drag(40, each) for each in (asked[:, : len(CONTROLS)], asked))
    np.testing.assert_array_equal(eight.weights, sixteen.weights)
    np.testing.assert_array_equal(eight.asked, sixteen.asked)


def test_nothing_asked_is_the_range_as_it_is(take: Take, dragger: Dragger) -> None:
    patch = dragger.drag(40, dragger.controls[40:50])
    assert (patch.start, patch.stop) == (40, 50)
    np.testing.assert_array_equal(patch.weights, take.weights[40:50])
    assert np.isnan(patch.asked).all() and patch.granted is not None and np.isnan(patch.granted).all()


@pytest.mark.parametrize(
    ("start", "shape"), [(-1, (5, 16)), (86, (5, 16)), (10, (0, 16)), (10, (5, 9)), (10, (5, 15)), (0, (91, 8))]
)
def test_frames_and_curves_that_are_not_there_are_refused(dragger: Dragger, start: int, shape: tuple[int, int]) -> None:
    with pytest.raises(EditError, match=f"Frames {start}:{start + shape[0]} are not within the take, which has 90"):
        dragger.drag(start, np.full(shape, 20.0))


@pytest.mark.parametrize("value", [np.inf, -np.inf, FARTHEST_MM**2, -(FARTHEST_MM**2)])
def test_curves_that_are_not_finite_are_refused(dragger: Dragger, value: float) -> None:
    asked = dragger.controls[10:20].copy()
    asked[3, LIPS] = value
    with pytest.raises(EditError, match="finite"):
        dragger.drag(10, asked)


def test_curves_measured_already_are_believed_and_eight_are_measured_again(take: Take) -> None:
    known = bundled_face().measure(take.weights)
    assert Dragger(take, known).controls is known
    np.testing.assert_array_equal(Dragger(take, known[:, : len(CONTROLS)]).controls, known)


def test_what_edits_before_asked_for_is_held_where_they_asked(take: Take, dragger: Dragger) -> None:
    chin = ALL_INDEX["chin_to_lip"]
    before = np.full_like(dragger.controls, np.nan)
    before[:, chin] = dragger.controls[:, chin]
    asked = dragger.controls[40:50].copy()
    asked[:, LIPS] += 3.0
    off = [
        np.abs(each.drag(40, asked, believability=0.0).reached[:, chin] - dragger.controls[34:56, chin])[6:16].max()
        for each in (Dragger(take, asked=before), dragger, Dragger(replace(take), asked=np.full_like(before, np.nan)))
    ]
    assert off[0] < 2e-3 and 0.02 < off[1] == off[2]
