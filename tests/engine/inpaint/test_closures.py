from __future__ import annotations

import numpy as np

from engine.controls import measure
from engine.inpaint.closures import TUNING, close_lips
from engine.inpaint.gap import gap_of
from engine.speech.visemes import NAMES
from engine.take import SHAPE_INDEX, SHAPES


def test_lips_meet_at_a_bilabial_and_nowhere_else() -> None:
    wide = np.zeros((40, len(SHAPES)))
    wide[:, SHAPE_INDEX["jawOpen"]] = 0.4
    known, visemes = np.full_like(wide, np.nan), np.zeros((40, len(NAMES)))
    known[:10] = wide[:10]
    visemes[20:23, NAMES.index("mbp")] = 1.0
    closed = close_lips(wide, gap_of(known, visemes=visemes))
    lips = measure(closed)[:, 0]
    assert lips[20:23].max() < 1.2 and np.abs(np.diff(lips)).max() < 0.7 * measure(wide)[0, 0]
    away = np.r_[0 : 20 - int(TUNING.ease_frames), 23 + int(TUNING.ease_frames) : 40]
    np.testing.assert_array_equal(closed[away], wide[away])


def test_a_control_target_for_the_lips_decides() -> None:
    wide, visemes, controls = np.full((20, len(SHAPES)), 0.3), np.zeros((20, len(NAMES))), np.full((20, 8), np.nan)
    visemes[:, NAMES.index("mbp")] = 1.0
    controls[:, 0] = 9.0
    gap = gap_of(np.full_like(wide, np.nan), visemes=visemes, controls=controls)
    np.testing.assert_array_equal(close_lips(wide, gap), wide)
