from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import QRect

from app.window.screen import fitted

sizes = st.integers(200, 5000)
places = st.integers(-4000, 4000)
borders = st.integers(0, 60)


@given(places, places, sizes, sizes, st.tuples(borders, borders, borders, borders), places, places, sizes, sizes)
def test_a_window_and_its_frame_come_to_lie_on_the_screen(
    x: int, y: int, width: int, height: int, frame: tuple[int, ...], left: int, top: int, wide: int, high: int
) -> None:
    window, available = QRect(x, y, width, height), QRect(left, top, wide, high)
    around = window.adjusted(-frame[0], -frame[1], frame[2], frame[3])
    box = fitted(window, around, available)
    assert available.contains(box.adjusted(-frame[0], -frame[1], frame[2], frame[3]))
    assert box.width() <= width and box.height() <= height
    if available.contains(around):
        assert box == window
