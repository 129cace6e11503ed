from __future__ import annotations

import numpy as np
import pytest

from engine.inpaint import infer, retrieval
from engine.inpaint.base import base_of
from engine.inpaint.fill import fill, fill_spans
from engine.inpaint.gap import gap_of
from engine.inpaint.infer import _soft_clip, bundled
from engine.inpaint.request import FillRequest
from engine.inpaint.retrieval import retrieval_share, retrieve, squared_distances
from engine.inpaint.seams import distance_frames, harmonic_frames
from engine.inpaint.statistics import statistics_of
from engine.lab.corpus import Piece, rest_of
from engine.take import SHAPES, Array, Take

WAVES = np.random.default_rng(0).uniform(20, 70, len(SHAPES))  # frames, a period for each shape

EVEN = np.ones(len(SHAPES))


def moving(frames: int, first: int = 0) -> Array:
    return 0.5 + 0.4 * np.sin(2 * np.pi * (first + np.arange(frames))[:, None] / WAVES)


def torn(truth: Array, start: int, stop: int) -> Array:
    known = truth.copy()
    known[start:stop] = np.nan
    return known


def test_squared_distances_equal_a_plain_loop() -> None:
    rng = np.random.default_rng(0)
    take, query = rng.random((40, len(SHAPES))), rng.random((7, len(SHAPES)))
    query[2:5] = query[6, :30] = np.nan
    plain = [np.nansum((take[start : start + 7] - query) ** 2) for start in range(34)]
    np.testing.assert_allclose(squared_distances(take, query), plain, atol=1e-9)


@pytest.mark.parametrize("length", [60, 110, 400])
def test_motion_that_the_take_holds_is_retrieved(length: int) -> None:
    truth = moving(length + 60)
    before = np.concatenate([np.random.default_rng(1).random((50, len(SHAPES))), truth, moving(40, 9000)])
    motion = retrieve(torn(truth, 30, 30 + length), [before], EVEN)
    assert motion is not None
    off, away = motion - truth, truth - before.mean(axis=0)
    assert (
        np.abs(off).mean() < 1.1 * retrieval.TUNING.shrinkage * np.abs(away).mean()
    )  # shrunk a little to the mean pose


def test_retrieved_motion_goes_through_seams_and_pins() -> None:
    known = torn(moving(180), 30, 150)
    known[80, :20] = 0.9
    motion = retrieve(known, [moving(500, 5000)], EVEN)
    there = np.isfinite(known)
    assert motion is not None
    np.testing.assert_allclose(motion[there], known[there], atol=1e-12)


def test_ranks_retrieve_different_stretches_of_which_the_first_is_nearest() -> None:
    truth = moving(150)
    known, rest = torn(truth, 30, 120), [moving(900, 4000)]
    motion = [retrieve(known, rest, EVEN, rank) for rank in range(3)]
    assert all(each is not None for each in motion)
    off = [float(np.abs(motion[0] - motion[rank]).max()) for rank in (1, 2)]  # type: ignore[operator]
    assert min(off) > 0.05


def test_nothing_is_retrieved_from_stretches_that_are_too_short() -> None:
    known = torn(moving(150), 30, 120)
    assert retrieve(known, [], EVEN) is None and retrieve(known, [moving(40)], EVEN) is None
    assert retrieve(known, [moving(60)], EVEN) is not None


def test_retrieved_motion_has_no_share_at_known_values_and_all_far_from_seams() -> None:
    share = retrieval_share(torn(moving(150), 30, 120))
    assert not share[:30].any() and not share[120:].any()
    assert share[30].max() < 0.1 and share[75].min() > 0.99
    assert retrieval_share(torn(moving(75), 30, 45)).max() < 0.7  # half a second between two seams is settled by them


def test_harmonic_frames_are_a_plain_formula_and_at_an_end_the_distance() -> None:
    known = np.array([[1.0], [np.nan], [np.nan], [np.nan], [2.0]])
    np.testing.assert_allclose(harmonic_frames(known)[:, 0], [0, 3 / 4, 1, 3 / 4, 0])
    open_end = torn(np.ones((100, 1)), 60, 100)
    assert harmonic_frames(open_end)[80, 0] > 0.8 * distance_frames(open_end)[80, 0]


def test_nothing_is_retrieved_under_guidance() -> None:
    truth = moving(150)
    statistics = statistics_of(truth)
    gap = gap_of(torn(truth, 30, 120), guide=truth, rest=[moving(900, 4000)])
    assert not base_of(gap, statistics).retrieved.any()
    assert base_of(gap_of(gap.known, rest=gap.rest), statistics).retrieved.any()


def test_the_rest_of_a_take_is_everything_but_the_hole() -> None:
    weights = moving(300)
    pieces = [
        Piece(weights[:200], True, "one", 10),
        Piece(weights[200:], True, "one", 230),
        Piece(weights, True, "two"),
    ]
    rest = rest_of(pieces, pieces[0], 50, 90)
    np.testing.assert_array_equal(np.concatenate(rest), np.delete(weights, np.arange(50, 90), axis=0))


@pytest.mark.parametrize("fps", [30.0, 60.0])
def test_fills_retrieve_from_their_take_and_seeds_differ(fps: float) -> None:
    take = Take(np.repeat(moving(900), round(fps / 30), axis=0), fps)
    pace = round(fps / 30)
    first, again, other = (fill(take, (400 * pace, 520 * pace), seed=seed)[0].take.weights for seed in (0, 0, 1))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other)[420 * pace : 500 * pace].mean() > 0.01


def test_fills_of_a_lively_take_are_livelier_than_fills_of_no_take() -> None:
    known = torn(moving(150), 30, 120)
    with_rest, alone = (bundled().fill(gap_of(known, rest=rest))[0][50:100] for rest in ([moving(900, 4000)], []))
    assert with_rest.std(axis=0).mean() > 1.5 * alone.std(axis=0).mean()


def test_nothing_is_retrieved_from_spans_still_to_be_filled() -> None:
    weights = moving(400)
    weights[250:300] = 1.0  # what the second span holds must not be seen in the first
    spoilt = weights.copy()
    spoilt[250:300] = 0.0
    spans = [(100, 180), (250, 300)]
    first = [fill_spans(Take(w, 30.0), spans, FillRequest((0, 0))).weights[100:180] for w in (weights, spoilt)]
    np.testing.assert_array_equal(*first)


def test_the_soft_clip_keeps_order_above_zero() -> None:
    weights = np.linspace(-1, 1, 201)[:, None]
    soft = _soft_clip(weights)
    assert (soft > 0).all() and (np.diff(soft, axis=0) > 0).all()
    assert np.abs(soft - np.maximum(weights, 0)).max() <= infer.TUNING.soft_clip / 2
