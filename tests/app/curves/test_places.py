from __future__ import annotations

import itertools

from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import QSizeF
from pytestqt.qtbot import QtBot

from app.curves.places import ACTIVE_SHARE, GAP_PX, GUTTER_PX, SHARE, Growth, boxes
from app.theme import GRID


@given(
    st.floats(0, 4000),
    st.floats(0, 4000),
    st.lists(st.integers(0, 60), min_size=1, max_size=30, unique=True),
    st.floats(SHARE, ACTIVE_SHARE),
)
def test_lanes_are_as_wide_as_the_panel_lets_them_and_fill_its_height(
    width: float, height: float, keys: list[int], share: float
) -> None:
    found = boxes(QSizeF(width, height), keys, dict.fromkeys(keys, SHARE) | {keys[0]: share})
    assert {box.left() for box in found} == {GUTTER_PX}
    assert {box.width() for box in found} == {max(1.0, int(width) - GUTTER_PX - GRID)}
    assert all(box.height() >= 1 and box.top() == int(box.top()) for box in found)
    for above, below in itertools.pairwise(found):
        assert GAP_PX - 1 <= below.top() - above.bottom() <= GAP_PX
    room = height - GAP_PX * (len(keys) - 1)
    if room > 10 * len(keys):
        assert abs(found[-1].bottom() - height) <= 1


def test_the_chosen_lane_grows_by_steps_and_never_while_held(qtbot: QtBot) -> None:
    growth, keys = Growth(), [0, 1, 2]
    growth.choose(keys, 0, at_once=False)
    assert growth.shares == {0: ACTIVE_SHARE, 1: SHARE, 2: SHARE}
    growth.hold()
    growth.choose(keys, 1, at_once=False)
    qtbot.wait(30)
    assert growth.shares == {0: ACTIVE_SHARE, 1: SHARE, 2: SHARE} and not growth.moving
    steps: list[float] = []
    growth.moved.connect(lambda: steps.append(growth.shares[1]))
    growth.release()
    qtbot.waitUntil(lambda: not growth.moving, timeout=5_000)
    assert growth.shares == {0: SHARE, 1: ACTIVE_SHARE, 2: SHARE}
    assert steps == sorted(steps) and len(set(steps)) > 2


def test_a_press_stops_the_lanes_where_they_are(qtbot: QtBot) -> None:
    growth, keys = Growth(), [0, 1]
    growth.choose(keys, 0, at_once=False)
    growth.choose(keys, 1, at_once=False)
    qtbot.waitUntil(lambda: growth.shares[1] > SHARE, timeout=5_000)
    growth.hold()
    shares = dict(growth.shares)
    qtbot.wait(30)
    assert growth.shares == shares
    growth.choose([0, 1, 2], 1, at_once=False)
    assert set(growth.shares) == {0, 1, 2}
