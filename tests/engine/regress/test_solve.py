"""An edit's parts against plain slow versions, and the whole against what it promises."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from engine.controls import ALL_CONTROLS, ALL_INDEX
from engine.extended import bundled_face
from engine.regress import infer
from engine.regress.solve import (
    FADE_FROM,
    FREE,
    KNOWN_FRAMES,
    Solver,
    Stretch,
    _beside,
    _between,
    _columns,
    _fade,
    _model_frames,
)
from engine.take import SHAPES, Array, Take

FACE = bundled_face()
LIPS, CORNER, CHIN = ALL_INDEX["lips_vertical"], ALL_INDEX["corner_left"], ALL_INDEX["chin_to_lip"]
FEATHER = 6  # frames of 0.2 s at 30 fps


def smooth(position: Array) -> Array:
    inside = np.clip(position, 0, 1)
    return inside**2 * (3 - 2 * inside)


@pytest.fixture(scope="module")
def solver() -> Solver:
    rng = np.random.default_rng(5)
    weights = np.clip(0.2 + np.cumsum(rng.normal(0, 0.01, (90, len(SHAPES))), axis=0), 0, 1)
    weights[:, SHAPES.index("mouthClose")] = 0.0
    take = Take(weights, 30.0)
    return Solver(take, FACE.measure(take.weights), infer.bundled())


def asked_of(solver: Solver, column: int, by: Array, start: int) -> Array:
    asked = np.full((len(by), len(ALL_CONTROLS)), np.nan)
    asked[:, column] = solver.controls[start : start + len(by), column] + by
    return asked


@pytest.mark.parametrize("margin", [0.0, 2.5])
def test_what_fades_is_full_down_to_a_tenth_and_falls_from_there(margin: float) -> None:
    for size in (
        np.interp(np.arange(60), [0, 20, 30, 60], [0.0, 0.0, 1.0, 0.0]),
        np.where(np.arange(60) == 30, 4.0, 0.0),
        np.ones(60),
        np.where(np.arange(60) > 40, 1.0, 0.0),
    ):
        fine = np.linspace(0, 59, 59_001)
        full = np.flatnonzero(np.interp(fine, np.arange(60), size) >= FADE_FROM * size.max())
        first, last = fine[full[0]], fine[full[-1]]
        away = np.maximum(0, np.maximum(first - np.arange(60), np.arange(60) - last) - margin)
        np.testing.assert_allclose(_fade(size, feather=5.0, margin=margin), smooth(1 - away / 5), atol=1e-3)


def test_what_was_asked_before_is_held_less_and_less_beside_its_frames() -> None:
    wanted = np.random.default_rng(2).random((40, 5)) < 0.06
    wanted[:, 4] = False
    expected = np.zeros(wanted.shape)
    for column in range(5):
        at = np.flatnonzero(wanted[:, column])
        for frame in range(40):
            if len(at):
                expected[frame, column] = smooth(1 - np.abs(at - frame).min() / 7.5)
    np.testing.assert_allclose(_beside(wanted, 7.5), expected, atol=1e-12)
    assert not expected[:, 4].any() and (expected[wanted] == 1).all()


@pytest.mark.parametrize("frames", [1, 2, 30, KNOWN_FRAMES, KNOWN_FRAMES + 1])
def test_between_frames_lies_a_spline(frames: int) -> None:
    curves = np.random.default_rng(0).random((frames, 3))
    at = np.linspace(0, frames - 1, 17)
    expected = CubicSpline(np.arange(frames), curves)(at) if frames > 1 else np.repeat(curves, 17, axis=0)
    np.testing.assert_allclose(_between(curves, at), expected, atol=1e-9)


@pytest.mark.parametrize("step", [0.4, 0.5, 1.0, 2.0])
def test_frames_of_the_model_are_laid_out_from_the_middle_of_what_is_asked(step: float) -> None:
    size = np.zeros(40)
    size[10:21] = [1, 2, 3, 4, 5, 6, 5, 4, 3, 2, 1]
    at, origin = _model_frames(size, step)
    assert at[origin] == pytest.approx(15.0, abs=0.01 * step)
    np.testing.assert_allclose(np.diff(at), step)
    assert at[0] >= -1e-6 and at[0] < step and at[-1] <= 39 + 1e-6 and at[-1] > 39 - step - 1e-6


def test_controls_of_an_area_are_those_that_say_so() -> None:
    for area in FREE:
        assert [ALL_CONTROLS[index].area for index in _columns(area)] == [area] * len(_columns(area))
        assert set(_columns(area, but=LIPS)) == set(_columns(area)) - {LIPS}
    assert sum(len(_columns(area)) for area in FREE) == len(ALL_CONTROLS)


def test_shapes_are_free_in_one_area_at_most_and_closing_the_mouth_in_none() -> None:
    free = np.sum([some.astype(int) for some in FREE.values()], axis=0)
    assert free.max() == 1 and not free[SHAPES.index("mouthClose")]
    assert {SHAPES[index] for index in np.flatnonzero(free == 0)} == {"mouthClose", "tongueOut"}


def test_frames_that_are_asked_for_are_solved_with_their_feather_and_no_more(solver: Solver) -> None:
    asked = asked_of(solver, LIPS, np.where((np.arange(40) >= 10) & (np.arange(40) < 15), 1.0, 0.0), 20)
    (found,) = solver.stretches(20, asked)
    assert (found.start, found.stop) == (30 - FEATHER, 35 + FEATHER)
    there = np.flatnonzero(np.isfinite(found.asked[:, LIPS]))
    assert there.tolist() == list(range(FEATHER, FEATHER + 5))
    assert np.isnan(np.delete(found.asked, LIPS, axis=1)).all()


def test_stretches_whose_feathers_do_not_touch_are_apart(solver: Solver) -> None:
    for between, count in ((2 * FEATHER, 1), (2 * FEATHER + 1, 2)):
        by = np.zeros(60)
        by[10], by[11 + between] = 1.0, -1.0
        assert len(solver.stretches(10, asked_of(solver, LIPS, by, 10))) == count
    assert solver.stretches(10, asked_of(solver, LIPS, np.zeros(60), 10)) == []
    assert solver.stretches(10, np.full((60, len(ALL_CONTROLS)), np.nan)) == []


def test_between_the_first_and_the_last_frame_that_is_asked_a_curve_is_asked_as_it_is(solver: Solver) -> None:
    by = np.where(np.isin(np.arange(20), [5, 12]), 2.0, np.where(np.arange(20) == 8, np.nan, 0.0))
    (found,) = solver.stretches(40, asked_of(solver, LIPS, by, 40))
    rows = np.flatnonzero(np.isfinite(found.asked[:, LIPS])) + found.start
    assert rows.tolist() == list(range(45, 53))
    own = solver.controls[45:53, LIPS]
    np.testing.assert_allclose(found.asked[rows - found.start, LIPS] - own, [2, 0, 0, 0, 0, 0, 0, 2], atol=1e-9)


@pytest.mark.parametrize(("start", "frames"), [(0, 4), (86, 4)])
def test_at_the_ends_of_a_take_there_is_no_feather(solver: Solver, start: int, frames: int) -> None:
    (found,) = solver.stretches(start, asked_of(solver, LIPS, np.ones(frames), start))
    assert (found.start, found.stop) == (max(0, start - FEATHER), min(90, start + frames + FEATHER))


def test_what_is_asked_is_reached_and_beyond_the_feather_nothing_moves(solver: Solver) -> None:
    (stretch,) = solver.stretches(40, asked_of(solver, LIPS, np.full(12, 2.0), 40))
    weights, granted = solver.solve(stretch, believability=0.0)
    wanted = np.isfinite(granted)
    assert (wanted == np.isfinite(stretch.asked)).all()
    np.testing.assert_allclose(granted[wanted], stretch.asked[wanted])
    np.testing.assert_allclose(FACE.measure(weights)[wanted], granted[wanted], atol=2e-3)
    own = solver.take.weights[stretch.start : stretch.stop]
    for area in ("gaze", "brows", "eyelids"):
        np.testing.assert_array_equal(weights[:, FREE[area]], own[:, FREE[area]])
    by = np.abs(weights - own).max(axis=1)
    assert by[[0, -1]].max() < 0.1 * by[FEATHER:-FEATHER].min()


def test_a_stretch_that_asks_for_what_is_there_comes_back_bit_for_bit(solver: Solver) -> None:
    asked = solver.controls[40:60].copy()
    weights, granted = solver.solve(Stretch(40, 60, asked), believability=0.0)
    np.testing.assert_array_equal(weights, solver.take.weights[40:60])
    np.testing.assert_allclose(granted, asked)


def test_values_that_edits_before_asked_for_stay(solver: Solver) -> None:
    (stretch,) = solver.stretches(40, asked_of(solver, LIPS, np.full(12, 3.0), 40))
    own = solver.controls[stretch.start : stretch.stop]
    held = np.zeros(own.shape, bool)
    held[:, CHIN] = True
    free, kept = (
        np.abs(FACE.measure(solver.solve(stretch, believability=0.0, held=each)[0]) - own)[6:-6, CHIN].max()
        for each in (None, held)
    )
    assert kept < 2e-3 and free > 0.02


def test_lips_that_touch_are_held_while_their_corners_move_and_those_apart_are_not(solver: Solver) -> None:
    rows = 11
    wanted, moved = np.zeros((rows, len(ALL_CONTROLS)), bool), np.zeros((rows, len(ALL_CONTROLS)))
    wanted[:, CORNER], moved[:, CORNER] = True, 1.0
    own = np.full((rows, len(ALL_CONTROLS)), 20.0)
    own[:, LIPS] = np.linspace(0.0, 10.0, rows)
    hold = solver._hold(moved, wanted, own, None)
    np.testing.assert_allclose(hold[:, LIPS], smooth((6 - own[:, LIPS]) / 5))
    assert (hold[:, CORNER] == 1).all() and not np.delete(hold, [LIPS, CORNER], axis=1).any()
    wanted[:, CHIN] = moved[:, CHIN] = True
    assert not solver._hold(moved, wanted, own, None)[:, LIPS].any()


def test_what_is_held_fades_from_half_of_it_on(solver: Solver) -> None:
    rows, frames = 41, 0.2 * 30
    wanted, moved = np.zeros((rows, len(ALL_CONTROLS)), bool), np.zeros((rows, len(ALL_CONTROLS)))
    wanted[20, CHIN], moved[20, CHIN] = True, 1.0
    hold = solver._hold(moved, wanted, np.full((rows, len(ALL_CONTROLS)), 20.0), None)
    away = np.maximum(0, np.abs(np.arange(rows) - 20) - 0.9 - frames / 2)
    np.testing.assert_allclose(hold[:, CHIN], smooth(1 - away / frames), atol=1e-9)
    wanted[20, CHIN], moved[20, CHIN] = False, 1.0
    held = np.zeros(wanted.shape, bool)
    held[10, LIPS] = True
    hold = solver._hold(moved, wanted, np.full((rows, len(ALL_CONTROLS)), 20.0), held)
    np.testing.assert_allclose(hold[:, LIPS], smooth(1 - np.abs(np.arange(rows) - 10) / frames), atol=1e-9)
    assert not hold[:, CHIN].any()


def test_an_edit_does_not_depend_on_what_a_take_does_elsewhere(solver: Solver) -> None:
    asked = asked_of(solver, LIPS, np.full(8, -1.0), 40)
    part = replace(solver.take, weights=solver.take.weights[20:80], lost=solver.take.lost[20:80],
                   rotations=solver.take.rotations[20:80])  # fmt: skip
    alone = Solver(part, solver.controls[20:80], infer.bundled())
    (whole,), (cut,) = solver.stretches(40, asked), alone.stretches(20, asked)
    assert (whole.start, whole.stop) == (cut.start + 20, cut.stop + 20)
    np.testing.assert_array_equal(solver.solve(whole, believability=0.0)[0], alone.solve(cut, believability=0.0)[0])
