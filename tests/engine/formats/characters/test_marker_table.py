from __future__ import annotations

import numpy as np
import pytest

from engine.errors import EditError
from engine.formats.characters.marker_table import MarkerMatch, MarkerTable

TABLE = MarkerTable(
    (
        MarkerMatch("a", "chin", 3.0, "by place"),
        MarkerMatch("b", "nose_tip", 0.0, "by name"),
        MarkerMatch("c", "", 9.0, "by place"),
    ),
    np.eye(3)[::-1],
)


def test_landmarks_are_those_of_the_rows_that_have_one() -> None:
    assert TABLE.landmarks == {"a": "chin", "b": "nose_tip"} and TABLE.left_out == frozenset()
    np.testing.assert_array_equal(MarkerTable().turn, np.eye(3))


def test_a_landmark_by_hand_is_taken_from_the_marker_that_had_it() -> None:
    found = TABLE.corrected({"c": "chin", "b": ""})
    assert found.rows == (
        MarkerMatch("a", "", 3.0, "by place"),
        MarkerMatch("b", "", 0.0, "left out"),
        MarkerMatch("c", "chin", 0.0, "by hand"),
    )
    assert found.landmarks == {"c": "chin"} and found.left_out == {"b"} and found.turn is TABLE.turn
    assert TABLE.corrected({}).rows == TABLE.rows


@pytest.mark.parametrize(
    ("changes", "says"), [({"x": "chin"}, "no marker called 'x'"), ({"a": "elbow"}, "place called 'elbow'")]
)
def test_what_is_not_there_is_named(changes: dict[str, str], says: str) -> None:
    with pytest.raises(EditError, match=says):
        TABLE.corrected(changes)
