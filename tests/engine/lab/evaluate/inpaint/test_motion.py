from __future__ import annotations

import numpy as np
import pytest

from engine.inpaint.gap import gap_of
from engine.lab.corpus import Piece
from engine.lab.evaluate.inpaint.baselines import Nearest, Propagation, hermite, linear, spline
from engine.lab.evaluate.inpaint.bezier import fit
from engine.lab.evaluate.inpaint.motion import closures, frechet, npss, seam_jumps, variety
from engine.take import SHAPE_INDEX, SHAPES


def test_spectra_alike_but_for_phase_and_size_are_no_distance() -> None:
    at = np.arange(60)[:, None] / 60
    one, other = np.sin(2 * np.pi * 5 * at), 3 * np.cos(2 * np.pi * 5 * at)
    assert npss([one], [other]) == pytest.approx(0, abs=1e-9)
    assert npss([one], [np.sin(2 * np.pi * 9 * at)]) == pytest.approx(4, abs=1e-6)  # four bins apart


def test_the_frechet_distance_of_gaussians_is_the_formula() -> None:
    rng = np.random.default_rng(0)
    one = rng.standard_normal((200_000, 2))
    assert frechet(one, one) == pytest.approx(0, abs=1e-5)
    assert frechet(one, 2 * one + [3, 0]) == pytest.approx(9 + 2, rel=0.02)


def test_closures_count_what_is_shut_in_both() -> None:
    shut, wide = np.zeros((4, len(SHAPES))), np.zeros((4, len(SHAPES)))
    wide[:, SHAPE_INDEX["jawOpen"]] = 1.0
    blink = shut.copy()
    blink[:, SHAPE_INDEX["eyeBlinkLeft"]] = blink[:, SHAPE_INDEX["eyeBlinkRight"]] = 1.0
    assert closures([shut, wide], [shut, wide]) == (1.0, 0.0)
    assert closures([shut], [wide])[0] == 0.0
    assert closures([wide], [blink])[1] == 1.0


def test_a_step_at_a_seam_is_measured() -> None:
    weights, hole = np.zeros((20, len(SHAPES))), np.zeros((20, len(SHAPES)), bool)
    weights[8:12], hole[8:12] = 0.25, True
    assert seam_jumps(weights, hole) == (0.25, 0.25)
    ramp = np.repeat(np.arange(20.0)[:, None], len(SHAPES), axis=1)
    assert seam_jumps(ramp, hole) == (1.0, 0.0)


def test_variety_is_the_distance_between_fills() -> None:
    assert variety(np.stack([np.zeros((5, 3)), np.full((5, 3), 0.2)])) == pytest.approx(0.2)


@pytest.fixture
def faces() -> np.ndarray:
    at = np.arange(200)[:, None] / 30
    return 0.4 + 0.2 * np.sin(at * np.linspace(1, 4, len(SHAPES)) + np.arange(len(SHAPES)))


def test_every_baseline_keeps_what_is_known(faces: np.ndarray) -> None:
    known = faces.copy()
    known[80:110] = np.nan
    known[95] = faces[95]
    ways = (linear, hermite, spline, Propagation(faces), Nearest([Piece(faces, True, "one")]))
    for way in ways:
        made = way(gap_of(known))
        there = np.isfinite(known)
        np.testing.assert_array_equal(made[there], known[there])
        assert np.isfinite(made).all()


def test_the_nearest_recording_finds_itself(faces: np.ndarray) -> None:
    known = faces.copy()
    known[80:110] = np.nan
    np.testing.assert_allclose(Nearest([Piece(faces, True, "one")])(gap_of(known)), faces, atol=1e-9)


def test_propagation_without_prior_is_a_straight_line_and_follows_a_guide(faces: np.ndarray) -> None:
    known = faces.copy()
    known[80:110] = np.nan
    way = Propagation(faces, prior=0.0)
    np.testing.assert_allclose(way(gap_of(known)), linear(gap_of(known)), atol=1e-9)
    guide = np.where(np.isnan(known), faces, np.nan)
    assert np.abs(way(gap_of(known, guide=guide)) - faces).max() < np.abs(linear(gap_of(known)) - faces).max()


def test_one_bezier_segment_holds_a_cubic_and_a_zigzag_needs_many() -> None:
    at = np.linspace(0, 1, 60)
    points, error = fit(at**3 - at)
    assert points == 2 and error < 1e-9
    assert fit(np.arange(20) % 2)[0] == 8  # a cubic passes any four values, so one segment for every three frames
