from __future__ import annotations

import numpy as np

from engine.inpaint.features import FEATURES, TUNING, features_of, features_without_controls
from engine.inpaint.gap import gap_of
from engine.inpaint.seams import nearest_known
from engine.inpaint.statistics import Statistics
from engine.take import SHAPES, Array
from tests.engine.inpaint.gaps import SPAN, controlled


def test_features_are_normalised_weights_velocities_masks_and_nearness(
    known: Array, truth: Array, statistics: Statistics
) -> None:
    features = features_of(gap_of(known), truth, statistics)
    shapes = len(SHAPES)
    assert features.shape == (len(truth), FEATURES) and features.dtype == np.float32
    np.testing.assert_allclose(features[:, :shapes] * statistics.scale + statistics.mean, truth, atol=1e-6)
    speed = features[5, shapes : 2 * shapes] * statistics.scale
    np.testing.assert_allclose(speed, (truth[6] - truth[4]) / 2, atol=1e-6)
    np.testing.assert_array_equal(features[:, 2 * shapes : 3 * shapes], np.isnan(known))
    near = -TUNING.near_frames * np.log(features[:, -2])
    np.testing.assert_allclose(near, nearest_known(known), atol=1e-3)
    assert nearest_known(known)[SPAN].max() == 45


def test_targets_are_features_unless_they_are_left_out(known: Array, truth: Array, statistics: Statistics) -> None:
    gap = controlled(known, truth, "lips_vertical")
    plain = features_of(gap_of(known), truth, statistics)
    np.testing.assert_array_equal(features_without_controls(gap, truth, statistics), plain)
    changed = np.flatnonzero((features_of(gap, truth, statistics) != plain).any(axis=0))
    assert FEATURES - 2 - 8 in changed and set(changed) <= set(range(FEATURES - 18, FEATURES - 2))
