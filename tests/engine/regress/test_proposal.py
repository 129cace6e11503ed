from __future__ import annotations

import numpy as np
import pytest

from engine.anatomy import MIRROR
from engine.controls import ALL_INDEX
from engine.extended import bundled_face
from engine.regress.areas import AREAS
from engine.regress.infer import bundled
from engine.regress.prior import MIRROR_CONTROL, MIRROR_SIGN
from engine.regress.proposal import Proposer
from engine.take import SHAPES

NAMES = tuple(area.name for area in AREAS)
RNG = np.random.default_rng(0)
WEIGHTS = np.clip(RNG.uniform(0, 0.4, (1, len(SHAPES))) + 0.1 * np.sin(np.arange(24)[:, None] / 5), 0, 1)
CURVES = bundled_face().measure(WEIGHTS)


@pytest.fixture(scope="module")
def proposer() -> Proposer:
    return Proposer(bundled())


def edited(by: float = 4.0) -> np.ndarray:
    curves = CURVES.copy()
    curves[8:16, ALL_INDEX["corner_left"]] += by
    return curves


def test_no_edit_proposes_nothing_and_areas_that_are_not_asked_move_nothing(proposer: Proposer) -> None:
    assert not proposer.change(CURVES, CURVES, NAMES).any()
    assert not proposer.change(CURVES, edited(), ()).any()
    lower = next(area for area in AREAS if area.name == "lower")
    change = proposer.change(CURVES, edited(), ("lower",))
    assert np.abs(change[8:16]).max() > 1e-3
    assert not np.delete(change, lower.shape_columns, axis=1).any()
    one_way = [SHAPES.index(name) for name in ("jawLeft", "jawRight", "mouthLeft", "mouthRight")]
    assert not change[:, one_way].any()


def test_a_mirrored_edit_proposes_the_mirrored_change(proposer: Proposer) -> None:
    mirrored = [MIRROR_SIGN * curves[:, MIRROR_CONTROL] for curves in (CURVES, edited())]
    change = proposer.change(CURVES, edited(), NAMES)
    np.testing.assert_allclose(proposer.change(*mirrored, NAMES), change[:, MIRROR], atol=1e-5)


@pytest.mark.parametrize("origin", [4, 8])
def test_frames_are_pooled_from_the_origin_in_fours(proposer: Proposer, origin: int) -> None:
    change = proposer.change(CURVES, edited(), NAMES)
    np.testing.assert_allclose(proposer.change(CURVES, edited(), NAMES, origin=origin), change, atol=1e-6)


def test_what_is_remembered_of_the_original_is_not_taken_for_another(proposer: Proposer) -> None:
    other = CURVES + 1.0
    fresh = Proposer(bundled()).change(other, edited(), NAMES, origin=2)
    proposer.change(CURVES, edited(), NAMES)
    np.testing.assert_array_equal(proposer.change(other, edited(), NAMES, origin=2), fresh)
