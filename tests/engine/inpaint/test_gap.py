from __future__ import annotations

import numpy as np

from engine.inpaint.gap import gap_of
from engine.take import SHAPES


def test_a_frame_is_guided_by_any_kind_of_guidance_and_by_nothing_else() -> None:
    known, plain = np.full((4, len(SHAPES)), np.nan), gap_of(np.full((4, len(SHAPES)), np.nan))
    assert not plain.guided.any()
    guide, controls, visemes = plain.guide.copy(), plain.controls.copy(), plain.visemes.copy()
    guide[0, 3], controls[1, 2], visemes[2, 5] = 0.0, 1.0, 1.0
    gap = gap_of(known, guide=guide, controls=controls, visemes=visemes)
    np.testing.assert_array_equal(gap.guided, [True, True, True, False])
