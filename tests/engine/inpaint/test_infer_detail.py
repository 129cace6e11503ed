from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from engine.controls import measure
from engine.inpaint import infer
from engine.inpaint.base import base_of
from engine.inpaint.gap import gap_of
from engine.inpaint.infer import bundled
from engine.inpaint.network import noise_curves
from engine.take import Array
from tests.engine.inpaint.gaps import SPAN, controlled


def test_detail_is_quick_and_only_where_controls_have_targets(known: Array, truth: Array) -> None:
    filler = bundled()
    gap = controlled(known, truth, "lips_vertical")
    samples = noise_curves(len(known), np.random.default_rng(0))[None]
    detail = filler._detail(gap, base_of(gap, filler.statistics), samples)[0]
    assert not detail[: SPAN.start].any() and not detail[SPAN.stop :].any() and detail[100:110].any()
    slow = gaussian_filter1d(detail, 2 * infer.TUNING.detail_frames, axis=0)
    assert np.square(slow).mean() < 0.1 * np.square(detail).mean()
    nothing = gap_of(known)
    assert not filler._detail(nothing, base_of(nothing, filler.statistics), samples).any()


def test_control_targets_are_met_by_the_fill_itself(known: Array, truth: Array) -> None:
    gap = controlled(known, truth, "lips_vertical", "lips_horizontal", "eyelid_left")
    fills = bundled().fill(gap, seeds=range(3))
    asked = np.isfinite(gap.controls)
    off = np.sqrt(np.mean([(measure(fill) - gap.controls)[asked] ** 2 for fill in fills]))
    assert off < 1.0 and np.abs(fills[0] - fills[1])[SPAN].mean() > 1e-3
