from __future__ import annotations

import numpy as np
import pytest

from engine.controls import CONTROL_INDEX, CONTROLS, bundled_measurer
from engine.exact import FREE, project
from engine.take import SHAPE_INDEX, SHAPES, Array

RIGHT_EYE = CONTROL_INDEX["eyelid_right"]
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
