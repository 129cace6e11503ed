from __future__ import annotations

import numpy as np
import pytest

from engine.controls import CONTROL_INDEX, CONTROLS, bundled_measurer
from engine.exact import FREE, SHORT_MM, project, shortfalls
from engine.take import SHAPE_INDEX, SHAPES, Array

LIPS, RIGHT_EYE = CONTROL_INDEX["lips_vertical"], CONTROL_INDEX["eyelid_right"]
MEASURER = bundled_measurer()


def faces(count: int, seed: int = 0) -> Array:
    rng = np.random.default_rng(seed)
    return np.where(rng.random((count, len(SHAPES))) < 0.3, rng.random((count, len(SHAPES))), 0.0)


@pytest.mark.parametrize("area", FREE)
def test_no_face_ends_further_from_what_is_asked_and_only_free_weights_move_in_range(area: str) -> None:
    before = faces(40)
    columns = np.array([index for index, control in enumerate(CONTROLS) if control.area == area])
    measured = MEASURER.measure(before)[:, columns]
    asked = MEASURER.measure(faces(40, seed=1))[:, columns]  # what another face does, so that some face can
    after = project(before, asked, columns, MEASURER, free=FREE[area])
    missing = np.linalg.norm(MEASURER.measure(after)[:, columns] - asked, axis=1)
    assert (missing <= np.linalg.norm(measured - asked, axis=1) + 1e-9).all()
    assert np.median(missing) < 0.5
    np.testing.assert_array_equal(after[:, ~FREE[area]], before[:, ~FREE[area]])
    assert after.min() >= 0 and after.max() <= 1


def test_lids_meet_instead_of_passing_each_other() -> None:
    before = np.zeros((30, len(SHAPES)))
    before[:, SHAPE_INDEX["eyeSquintRight"]] = np.linspace(0, 1, 30)
    before[:, SHAPE_INDEX["eyeWideRight"]] = np.linspace(0.5, 0, 30)
    after = project(before, np.zeros((30, 1)), np.array([RIGHT_EYE]), MEASURER, free=FREE["eyelids"])
    assert MEASURER.measure(after)[:, RIGHT_EYE].max() < 0.7


def test_what_no_face_reaches_is_told_with_the_limit_that_was_met() -> None:
    asked = np.full((1, len(CONTROLS)), np.nan)
    asked[0, LIPS] = 150.0
    made = project(np.zeros((1, len(SHAPES))), asked[:, [LIPS]], np.array([LIPS]), MEASURER, free=FREE["lower"])
    (short,) = shortfalls(made, asked, MEASURER, exact_curve=True)
    assert (short.control, short.row, short.asked) == (LIPS, 0, 150.0)
    assert short.reached == pytest.approx(MEASURER.measure(made)[0, LIPS])
    assert "jawOpen" in short.why and "limit" in short.why
    assert str(short).startswith(f"lips apart {short.reached:.1f} mm of 150.0 asked: ")


def test_what_holds_a_control_back_is_told() -> None:
    """A face at rest with room to move: not a limit keeps it, but belief, or what else was asked."""
    rest = np.full((1, len(SHAPES)), 0.3)
    asked = np.full((1, len(CONTROLS)), np.nan)
    asked[0, LIPS] = MEASURER.measure(rest)[0, LIPS] + 4.0
    assert "believable" in shortfalls(rest, asked, MEASURER, exact_curve=False)[0].why
    asked[0, CONTROL_INDEX["chin_to_lip"]] = MEASURER.measure(rest)[0, CONTROL_INDEX["chin_to_lip"]]
    assert "chin to lip" in shortfalls(rest, asked, MEASURER, exact_curve=True)[0].why


def test_nothing_is_told_of_what_is_met_or_never_asked() -> None:
    made = faces(10)
    asked = MEASURER.measure(made) + np.random.default_rng(2).uniform(-SHORT_MM, SHORT_MM, (10, len(CONTROLS)))
    assert shortfalls(made, asked, MEASURER, exact_curve=True) == []
    assert shortfalls(made, np.full((10, len(CONTROLS)), np.nan), MEASURER, exact_curve=True) == []
