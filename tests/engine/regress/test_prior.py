from __future__ import annotations

import numpy as np
import pytest

from engine.anatomy import MIRROR
from engine.controls import ALL_CONTROLS
from engine.regress.prior import ACROSS, MIRROR_CONTROL, MIRROR_SIGN, bundled_prior, despiked
from engine.take import SHAPES


def test_controls_mirror_each_other_and_sideways_ones_change_their_sign() -> None:
    np.testing.assert_array_equal(MIRROR_CONTROL[MIRROR_CONTROL], np.arange(len(ALL_CONTROLS)))
    for at, control in enumerate(ALL_CONTROLS):
        other = ALL_CONTROLS[MIRROR_CONTROL[at]].name
        sides = {"left", "right"} & set(control.name.split("_"))
        assert (other != control.name) == bool(sides) and MIRROR_SIGN[at] in (-1.0, 1.0)
    assert {ALL_CONTROLS[at].name for at in np.flatnonzero(MIRROR_SIGN < 0)} == {"jaw_sideways", "gaze_horizontal"}


@pytest.mark.parametrize("stiffness", [0.0, 100.0])
def test_the_metric_is_a_covariance_alike_on_both_sides(stiffness: float) -> None:
    prior = bundled_prior()
    metric = prior.metric(stiffness)
    np.testing.assert_allclose(metric, metric.T, atol=1e-9)
    np.testing.assert_allclose(metric[np.ix_(MIRROR, MIRROR)], metric, atol=1e-12)
    assert np.linalg.eigvalsh(metric).min() > -1e-9 and not metric[ACROSS].any()
    if stiffness == 0:
        np.testing.assert_allclose(
            metric, np.where(ACROSS, 0, (prior.covariance + prior.covariance[np.ix_(MIRROR, MIRROR)]) / 2), atol=1e-9
        )
    else:
        assert np.trace(metric) < np.trace(prior.metric(0.0))
    left, right = SHAPES.index("mouthSmileLeft"), SHAPES.index("mouthSmileRight")
    assert ACROSS[left, right] and ACROSS[right, left] and not ACROSS[left, left]
    assert not ACROSS[SHAPES.index("jawLeft")].any()


@pytest.mark.parametrize("share", [0.75, 0.995])
def test_a_ball_holds_its_share_of_recorded_faces_whitened(share: float) -> None:
    prior = bundled_prior()
    for names, faces in (
        (("lips_vertical", "corner_left"), prior.faces),
        (("lips_vertical", "eyelid_left"), prior.faces[prior.whole]),
    ):
        columns = np.array([[c.name for c in ALL_CONTROLS].index(name) for name in names])
        mean, whiten, radius = prior.ball(columns, share)
        white = (faces[:, columns] - mean) @ whiten.T
        np.testing.assert_allclose(white.mean(axis=0), 0, atol=1e-9)
        np.testing.assert_allclose(np.cov(white.T), np.eye(2), atol=0.06)
        assert (np.linalg.norm(white, axis=1) <= radius).mean() == pytest.approx(share, abs=2 / len(white))
        assert prior.ball(columns, share)[0] is mean


@pytest.mark.parametrize(("fps", "width"), [(30.0, 5), (60.0, 11), (120.0, 21), (24.0, 5), (10.0, 3)])
def test_a_spike_shorter_than_half_the_median_is_taken_off_and_a_longer_one_stays(fps: float, width: int) -> None:
    for length, kept in ((width // 2, False), (width // 2 + 1, True)):
        curve = np.zeros((60, 2))
        curve[30 : 30 + length, 1] = 1.0
        assert bool(despiked(curve, fps=fps).any()) == kept
