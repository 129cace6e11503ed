from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.controls import measure
from engine.errors import EditError
from engine.formats import read_take
from engine.formats.audio import Audio
from engine.lab.performer import demo
from engine.quality import flags_of, sound_of
from engine.quality.seen import LIDS, drops, lowest, rounded, seen_of, strengths
from engine.take import SHAPES, Take, runs
from tests.engine.quality.takes import looked


def test_loudness_is_measured_once_a_frame() -> None:
    samples = np.zeros(16_000, np.float32)
    samples[8_000:9_600] = 0.5  # from 0.5 s to 0.6 s
    sound = sound_of(Audio(samples, 16_000), fps=50.0, offset_s=2.0)
    assert sound.duration_s == 1.0 and sound.offset_s == 2.0 and len(sound.loudness) == 50
    assert np.flatnonzero(sound.loudness > 0.4).tolist() == [25, 26, 27, 28, 29]


def plain_drops(gap: np.ndarray, within: int) -> np.ndarray:
    """Frame by frame: where a lid is at its lowest, how far it fell to there and rises from there, the lesser."""
    found = np.zeros(len(gap))
    for at, value in enumerate(gap):
        around = gap[max(0, at - within) : at + within + 1]
        if value <= around.min() and (at == 0 or value < gap[at - 1]):
            found[at] = min(gap[max(0, at - within) : at + 1].max() - value, gap[at : at + within + 1].max() - value)
    return found


@pytest.mark.parametrize("within", [1, 2, 3, 6])
def test_drops_equal_a_plain_loop(within: int) -> None:
    rng = np.random.default_rng(within)
    for frames in (1, 2, 5, 80):
        gap = np.round(rng.random(frames) * 6)  # with equal neighbours
        np.testing.assert_array_equal(drops(gap, within), plain_drops(gap, within))


def test_the_lowest_of_ranges_is_that_of_each() -> None:
    curve = np.random.default_rng(0).random(50)
    ranges = np.array([[0, 1], [0, 50], [7, 12], [49, 50], [3, 4]])
    np.testing.assert_array_equal(lowest(curve, ranges), [curve[a:b].min() for a, b in ranges])
    assert lowest(curve, np.zeros((0, 2), int)).shape == (0,)


@pytest.mark.parametrize("chunk", [1, 7, 4096])
@pytest.mark.parametrize(("low", "high"), [(0, 90), (13, 14), (40, 77)])
def test_a_verdict_in_parts_is_that_on_the_whole(chunk: int, low: int, high: int, monkeypatch) -> None:
    monkeypatch.setattr("engine.quality.seen._CHUNK", chunk)
    seen = looked(np.random.default_rng(0).random((90, len(SHAPES))))
    seen = replace(seen, lost=np.arange(90) % 11 == 3)

    def verdict(weights: np.ndarray, kept: np.ndarray) -> np.ndarray:
        """Of each row, the sum of the two rows to either side that have a face."""
        row = weights[:, 5] * kept
        return sum(np.pad(row, 2)[shift : shift + len(row)] for shift in range(5))

    whole = verdict(seen.weights, seen.kept)[low:high]
    np.testing.assert_allclose(strengths(seen, low, high, reach=2, verdict=verdict), whole)


@pytest.mark.parametrize(("seconds", "frames"), [(0.2, 6), (0.05, 2), (0.04, 1), (0.001, 1), (0.0, 1)])
def test_a_time_lasts_at_least_a_frame(seconds: float, frames: int) -> None:
    assert looked(np.zeros((9, len(SHAPES)))).frames(seconds) == frames


def test_curves_are_equal_to_a_millionth() -> None:
    np.testing.assert_array_equal(rounded(np.array([1.0000004, 1.0000006, -2.5])), [1.0, 1.000001, -2.5])


def test_blinks_are_of_the_wider_open_lid() -> None:
    seen = looked(np.zeros((30, len(SHAPES))))
    controls = np.zeros_like(seen.controls)
    controls[:, LIDS["Right"]] = np.abs(np.arange(30.0) - 15)
    controls[:, LIDS["Left"]] = 9.0
    gap, drop = replace(seen, controls=controls).blinks
    np.testing.assert_array_equal(gap, np.maximum(9.0, np.abs(np.arange(30.0) - 15)))
    assert not drop[:9].any()


def test_a_take_beside_its_original_is_seen_with_both() -> None:
    rng = np.random.default_rng(2)
    turned = np.concatenate([rng.random((20, 3)), np.zeros((20, 6))], axis=1)
    now, before = (Take(rng.random((20, len(SHAPES))), 25.0, rotations=turned) for _ in range(2))
    seen = seen_of(now, before)
    np.testing.assert_array_equal(seen.weights, now.weights)
    np.testing.assert_array_equal(seen.original_weights, before.weights)
    np.testing.assert_array_equal(seen.rotations, turned[:, :3])
    np.testing.assert_allclose(seen.controls[:, :8], measure(now.weights))
    np.testing.assert_allclose(seen.original_controls[:, :8], measure(before.weights))
    alone = seen_of(now)
    assert alone.original_controls is None and alone.original_weights is None and alone.fps == 25.0
    np.testing.assert_array_equal(alone.controls, seen.controls)
    known = np.zeros((20, 16)), np.ones((20, 16))
    assert seen_of(now, before, controls=known).original_controls is known[1]
    assert seen_of(now, controls=known).controls is known[0]
    assert seen_of(replace(now, rotations=turned * 0)).rotations is None
    with pytest.raises(EditError, match="The original has 1 frame, the take 20"):
        seen_of(now, Take(np.zeros((1, len(SHAPES))), 25.0))


def test_a_lost_frame_that_was_filled_is_not_flagged() -> None:
    take = read_take(demo.BUNDLED)
    (start, stop), *_ = runs(take.lost)
    filled = take.with_rows(start, take.weights[start:stop] + 0.01)
    assert "lost" in {flag.kind for flag in flags_of(seen_of(take, take))}
    assert "lost" not in {flag.kind for flag in flags_of(seen_of(filled, take))}
