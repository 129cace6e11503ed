from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.character import bundled
from engine.spacetime.closure import GAPS, Gaps, closedness

RNG = np.random.default_rng(0)


def test_gaps_are_the_distances_between_their_landmarks_on_the_moving_head() -> None:
    head, weights = bundled(), RNG.random((7, 52))
    gaps = Gaps(head)
    assert gaps.gaps == GAPS
    found = gaps.sizes(weights)
    for row, frame in zip(found, weights, strict=True):
        posed = head.neutral.astype(float) + np.tensordot(frame, head.deltas.astype(float), 1)
        for size, gap in zip(row, GAPS, strict=True):
            between = posed[head.landmarks[gap.upper]] - posed[head.landmarks[gap.lower]]
            assert size == pytest.approx(np.linalg.norm(between), abs=1e-4)
    np.testing.assert_array_equal(gaps.closedness(weights), closedness(found))


@pytest.mark.parametrize(
    ("name", "sizes", "shares"),
    [
        ("lips", [0.0, 2.0, 2.75, 3.5, 4.25, 5.0, 9.0], [1, 1, 27 / 32, 0.5, 5 / 32, 0, 0]),
        ("lids_left", [1.0, 2.0, 2.5, 3.0, 3.5, 4.0, np.nan], [1, 1, 27 / 32, 0.5, 5 / 32, 0, 0]),
    ],
)
def test_a_gap_closes_smoothly_between_its_two_sizes(name: str, sizes: list[float], shares: list[float]) -> None:
    (gap,) = (gap for gap in GAPS if gap.name == name)
    np.testing.assert_allclose(closedness(np.array(sizes)[:, None], (gap,))[:, 0], shares)


def test_a_head_that_lacks_landmarks_has_fewer_gaps() -> None:
    few = {name: at for name, at in bundled().landmarks.items() if name != "lid_lower_left"}
    gaps = Gaps(replace(bundled(), landmarks=few))
    assert [gap.name for gap in gaps.gaps] == ["lips", "lips_left", "lips_right", "lids_right"]
    without = [index for index, gap in enumerate(GAPS) if gap.name != "lids_left"]
    weights = RNG.random((3, 52))
    np.testing.assert_allclose(gaps.sizes(weights), Gaps(bundled()).sizes(weights)[:, without])
