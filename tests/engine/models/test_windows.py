from __future__ import annotations

import numpy as np
import pytest

from engine.models.windows import windows

CURVES = np.arange(50.0)[:, None] * [1, 10]


@pytest.mark.parametrize(("length", "overlap", "starts"), [
    (10, 0.5, range(0, 41, 5)), (10, 0.0, range(0, 41, 10)), (20, 0.9, range(0, 31, 2)), (50, 0.5, [0]), (8, 1.0, range(43))
])  # fmt: skip
def test_windows_overlap_by_their_share(length: int, overlap: float, starts) -> None:
    made = windows(CURVES, length=length, overlap=overlap)
    np.testing.assert_array_equal(made, np.stack([CURVES[start : start + length] for start in starts]))


def test_short_curves_are_held_at_their_end() -> None:
    made = windows(CURVES[:3], length=6, overlap=0.5)
    np.testing.assert_array_equal(made, CURVES[None, [0, 1, 2, 2, 2, 2]])
