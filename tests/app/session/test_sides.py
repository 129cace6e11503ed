from __future__ import annotations

import numpy as np

from app.session.sides import Dot, Side


def test_a_dot_that_is_not_placed_is_nowhere_and_on_no_vertex() -> None:
    first, second = Dot("lip"), Dot("lid")
    assert first.vertex == -1 and np.isnan(first.place).all() and first.place.shape == (3,) and not first.chosen
    assert first.place is not second.place


def test_a_side_has_the_bundled_head_and_nothing_to_pick_unless_it_says_so() -> None:
    side = Side("take", None)
    assert side.head is None and side.dots == () and side.box is None and not side.pickable and side.hint == ""
