from __future__ import annotations

import numpy as np
import pytest

from engine.errors import EditError
from engine.pose import FARTHEST, filled
from engine.take import SHAPE_INDEX, SHAPES


def test_a_pose_of_some_shapes_leaves_the_others_free() -> None:
    found = filled({"jawOpen": 0.25, "tongueOut": -FARTHEST, "mouthClose": FARTHEST})
    asked = {name: found[at] for name, at in SHAPE_INDEX.items() if not np.isnan(found[at])}
    assert asked == {"jawOpen": 0.25, "tongueOut": -1e4, "mouthClose": 1e4}
    assert np.isnan(filled({})).all()


def test_a_whole_pose_is_taken_as_it_is_and_may_leave_shapes_free() -> None:
    weights = np.where(np.arange(len(SHAPES)) % 3 == 0, np.nan, np.linspace(-1, 2, len(SHAPES)))
    np.testing.assert_array_equal(filled(weights), weights)
    edge = np.full(len(SHAPES), FARTHEST)
    np.testing.assert_array_equal(filled(-edge), -edge)


@pytest.mark.parametrize(
    ("pose", "says"),
    [
        (np.zeros(51), "needs 52 finite weights, this one has 51"),
        (np.zeros((1, 52)), "needs 52 finite weights"),
        (np.full(52, 1e4 + 1), "needs 52"),
        (np.full(52, -np.inf), "needs 52"),
        ({"grin": 1.0}, "no shape called 'grin'"),
        ({"jawOpen": float("nan")}, "weight of jawOpen is not a number"),
        ({"jawOpen": 10_001.0}, "weight of jawOpen"),
        ({"jawOpen": -10_001.0}, "weight of jawOpen"),
    ],
)
def test_what_no_face_could_take_is_a_sentence(pose, says: str) -> None:
    with pytest.raises(EditError, match=says):
        filled(pose)
