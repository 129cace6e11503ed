from __future__ import annotations

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import QRectF

from app.curves.overlay import Underlay

AREA = QRectF(100, 20, 640, 300)
SPANS = st.lists(st.tuples(st.integers(0, 5000), st.integers(1, 400)), max_size=30)


def columns(boxes: list[tuple[float, float]]) -> set[int]:
    """Return the columns of pixels that boxes reach into, of those on screen."""
    return {
        pixel
        for left, right in boxes
        for pixel in range(int(np.floor(max(left, 100))), int(np.floor(min(right, 740) - 1e-9)) + 1)
        if 100 <= pixel < 740
    }


@given(SPANS, st.floats(0, 4000), st.floats(2, 3000))
def test_spans_cover_the_same_pixels_as_when_each_is_drawn(spans, first: float, shown: float) -> None:
    def x_of(frame: float) -> float:
        return 100 + (frame - first) / shown * 640

    underlay = Underlay(lambda: AREA, x_of)
    underlay.spans = [(float(start), float(start + length)) for start, length in spans]
    plain = [(x_of(start - 0.5), max(x_of(start - 0.5) + 1, x_of(stop - 0.5))) for start, stop in underlay.spans]
    drawn = underlay._stretches(AREA)
    assert columns(plain) <= columns(drawn) and len(columns(drawn) - columns(plain)) <= 2
    assert all(one[1] < other[0] for one, other in pairwise(drawn))


def test_thousands_of_spans_are_no_more_boxes_than_there_are_pixels() -> None:
    underlay = Underlay(lambda: AREA, lambda frame: 100 + frame / 40_000 * 640)
    underlay.spans = [(2.0 * index, 2.0 * index + 1) for index in range(20_000)]
    assert len(underlay._stretches(AREA)) <= 640
