from __future__ import annotations

import numpy as np
import pytest

from engine.anatomy import MIRROR
from engine.errors import EditError
from engine.inpaint.regions import REGIONS, region_shapes
from engine.take import SHAPES


def test_upper_and_lower_part_the_face_and_left_mirrors_right() -> None:
    assert region_shapes("face").all() and REGIONS["face"].shape == (52,)
    np.testing.assert_array_equal(REGIONS["upper"], ~REGIONS["lower"])
    np.testing.assert_array_equal(REGIONS["left"][MIRROR], REGIONS["right"])
    assert not (REGIONS["left"] & REGIONS["right"]).any()
    sided = {name for name in SHAPES if name.endswith(("Left", "Right"))}
    beside = {SHAPES[at] for at in np.flatnonzero(REGIONS["left"] | REGIONS["right"])}
    assert sided - beside == {"jawLeft", "jawRight", "mouthLeft", "mouthRight"} and beside < sided
    assert {SHAPES[at] for at in np.flatnonzero(REGIONS["eyes"])} == {name for name in SHAPES if name.startswith("eye")}
    lower = {SHAPES[at] for at in np.flatnonzero(REGIONS["lower"])}
    assert {"jawOpen", "mouthClose", "cheekPuff", "tongueOut"} <= lower and "cheekSquintLeft" not in lower
    assert not any(mask.flags.writeable for mask in REGIONS.values())


def test_a_region_that_is_none_is_named_with_those_that_are() -> None:
    with pytest.raises(EditError, match="no region called 'ears'") as told:
        region_shapes("ears")
    assert all(name in told.value.advice for name in REGIONS)
