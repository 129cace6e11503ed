from __future__ import annotations

import numpy as np
import pytest

from engine.errors import EditError
from engine.live.record import LEAPT, Recorder, rate_of
from engine.live.stream import Arrival
from engine.take import SHAPES

RNG = np.random.default_rng(0)
WEIGHTS = RNG.random((300, len(SHAPES))).astype(np.float32)


def test_nothing_recorded_is_said() -> None:
    with pytest.raises(EditError, match="Nothing was recorded"):
        Recorder().take()


def test_a_recorder_keeps_no_more_than_it_may(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("engine.live.record.MAX_FRAMES", 5)
    recorder = Recorder()
    for index in range(9):
        recorder.add(Arrival(index / 60, 60.0, WEIGHTS[0], np.zeros(9, np.float32), late=False))
    assert len(recorder) == 5 and recorder.full and len(recorder.take()) == 5


def test_slow_rates_among_fast_ones_cannot_fill_the_memory() -> None:
    recorder = Recorder()
    times_s = np.cumsum(np.where(np.arange(3000) % 3, 0.001, 9.0))
    for time_s in times_s:
        recorder.add(Arrival(float(time_s), 1000.0, WEIGHTS[0], np.zeros(9, np.float32), False))
    taken = recorder.take()
    assert len(taken) < 200_000 and "shortened" in taken.notices[0]
    assert int((~taken.lost).sum()) == 3000  # no face is dropped for it


def test_a_recording_with_ordinary_pauses_keeps_them() -> None:
    recorder = Recorder()
    times_s = np.concatenate([np.arange(100) / 60, 9.0 + np.arange(100) / 60])
    for time_s in times_s:
        recorder.add(Arrival(float(time_s), 60.0, WEIGHTS[0], np.zeros(9, np.float32), False))
    assert len(recorder.take()) == round((9.0 + 99 / 60) * 60) + 1 and not recorder.take().notices


def arrivals(frames: list[int], fps: float = 60.0, *, lost: tuple[int, ...] = ()) -> Recorder:
    recorder = Recorder()
    for order, frame in enumerate(frames):
        weights = None if frame in lost else WEIGHTS[order % 300]
        recorder.add(Arrival(5.0 + frame / fps, fps, weights, np.full(9, order, np.float32), late=False))
    return recorder


def test_what_is_kept_comes_back_from_any_place_across_chunks() -> None:
    recorder, count = Recorder(), 4096 + 300
    faces = RNG.random((count, len(SHAPES))).astype(np.float32)
    for index in range(count):
        weights = None if index % 7 == 3 else faces[index]
        recorder.add(Arrival(index / 60, 59.0, weights, np.full(9, index, np.float32), late=bool(index % 2)))
    for first in (0, 1, 4095, 4096, 4097, count - 1, count, count + 5):
        rows = recorder.since(first)
        assert rows.shape == (max(0, count - first), 63)
        numbers = np.arange(first, count)
        np.testing.assert_array_equal(rows[:, 0], numbers / 60)
        assert (rows[:, 1] == 59.0).all() and (rows[:, 54:] == numbers[:, None]).all()
        faceless = numbers % 7 == 3
        assert np.isnan(rows[faceless, 2:54]).all()
        np.testing.assert_array_equal(rows[~faceless, 2:54], faces[numbers[~faceless]])


def test_of_a_doubled_frame_the_later_arrival_counts_and_order_does_not() -> None:
    taken = arrivals([0, 1, 2, 1, 4, 3]).take("live")
    np.testing.assert_array_equal(taken.weights, WEIGHTS[[0, 3, 2, 5, 4]])
    assert not taken.lost.any() and taken.name == "live" and taken.rotations[1, 0] == 3


def test_frames_without_a_face_are_lost_and_lie_between_their_neighbours() -> None:
    taken = arrivals([0, 1, 2, 3, 6, 7], lost=(0, 2, 7)).take()
    assert taken.lost.tolist() == [False, True, False, True, True, False, True]  # it begins with the first face
    np.testing.assert_allclose(taken.weights[1], (WEIGHTS[1] + WEIGHTS[3]) / 2, atol=1e-6)
    np.testing.assert_allclose(taken.weights[4], WEIGHTS[3] + (WEIGHTS[4] - WEIGHTS[3]) * 2 / 3, atol=1e-6)
    np.testing.assert_array_equal(taken.weights[6], WEIGHTS[4])
    np.testing.assert_allclose(taken.rotations[:, 0], [1, 2, 3, 3 + 1 / 3, 3 + 2 / 3, 4, 4])


@pytest.mark.parametrize(
    ("step_s", "stated", "fps"),
    [
        (1 / 30, 60.0, 30.0),
        (1 / 59.94, 60.0, 60.0),
        (1 / 61.5, 60.0, 1 / (1 / 61.5)),
        (1 / 29.3, 30.0, 29.3),
        (1 / 24, 60.0, 24.0),
        (1 / 119, 120.0, 120.0),
        (0.0, 48.0, 50.0 if abs(50 / 48 - 1) < 0.02 else 48.0),
        (0.0004, 60.0, 500.0),
    ],
)
def test_the_rate_is_that_of_the_usual_step(step_s: float, stated: float, fps: float) -> None:
    times = np.cumsum(np.where(np.arange(50) % 9 == 4, 5 * step_s, step_s))
    assert rate_of(times, np.full(50, stated)) == pytest.approx(fps, rel=1e-9)


def test_gaps_are_shortened_only_where_they_are_too_many_and_no_two_frames_meet() -> None:
    plain = np.array([*range(30), 40, 19_999])
    recorder = arrivals(plain.tolist())
    assert len(recorder.take()) == 20_000 and not recorder.take().notices
    far = arrivals([*range(30), 40, 40_000, 90_000]).take()
    assert len(far) < 20_000 and far.notices == (LEAPT,) and int((~far.lost).sum()) == 33
    np.testing.assert_array_equal(np.flatnonzero(~far.lost)[:31], [*range(30), 40])
