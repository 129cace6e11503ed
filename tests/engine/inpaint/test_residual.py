from __future__ import annotations

import numpy as np

from engine.controls import CONTROL_INDEX
from engine.inpaint.gap import gap_of
from engine.inpaint.residual import gate_small_motion, unexplained_share
from engine.inpaint.statistics import Statistics
from engine.take import SHAPES, Array
from tests.engine.inpaint.gaps import SPAN, controlled


def test_fewer_targets_leave_more_unexplained_and_none_adds_nothing(
    known: Array, truth: Array, statistics: Statistics
) -> None:
    three = unexplained_share(controlled(known, truth, "lips_vertical", "lips_horizontal", "eyelid_left"), statistics)
    eight = unexplained_share(controlled(known, truth, *CONTROL_INDEX), statistics)
    assert (eight <= three + 1e-9).all() and eight.mean() < three.mean() and eight.min() >= 0 and three.max() <= 1
    assert not three[np.isfinite(known)].any()
    assert not unexplained_share(gap_of(known), statistics).any()


def test_small_motion_is_gated_at_guided_frames_alone(known: Array, truth: Array) -> None:
    motion = np.random.default_rng(0).standard_normal(known.shape) * np.geomspace(1e-4, 0.3, len(SHAPES))
    np.testing.assert_array_equal(gate_small_motion(motion, gap_of(known)), motion)
    steered = gate_small_motion(motion, controlled(known, truth, "lips_vertical"))[SPAN]
    share = np.abs(steered).mean(axis=0) / np.abs(motion[SPAN]).mean(axis=0)
    assert (share <= 1).all() and (np.diff(share) > -0.05).all() and share[0] < 0.01 and share[-1] > 0.95
