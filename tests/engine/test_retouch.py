from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from engine.errors import EditError
from engine.retouch import PASTE_FEATHER_S, paste, replace_weight, smooth
from engine.take import SHAPE_INDEX, Take

JAW = SHAPE_INDEX["jawOpen"]


@pytest.fixture
def take() -> Take:
    rng = np.random.default_rng(0)
    time = np.arange(300) / 60
    weights = 0.5 + 0.3 * np.sin(2 * np.pi * time)[:, None] * rng.random(52) + 0.02 * rng.standard_normal((300, 52))
    return Take(weights=np.clip(weights, 0, 1), fps=60.0)


def test_smoothing_in_the_middle_equals_filtering_the_whole_take(take: Take) -> None:
    patch = smooth(take, (0, 300), 6.0)
    whole = sosfiltfilt(butter(2, 6.0, fs=60.0, output="sos"), take.weights, axis=0, padlen=9)
    np.testing.assert_allclose(patch.weights, np.clip(whole, 0, 1), atol=1e-12)
    part = smooth(take, (100, 200), 6.0)
    np.testing.assert_allclose(part.weights[30:70], np.clip(whole, 0, 1)[130:170], atol=1e-4)


def test_smoothing_moves_no_peak_in_time() -> None:
    frame = np.arange(200)
    weights = np.zeros((200, 52))
    weights[:, JAW] = np.exp(-(((frame - 97) / 9) ** 2))
    smoothed = smooth(Take(weights=weights, fps=30.0), (0, 200), 3.0).weights[:, JAW]
    assert np.argmax(smoothed) == 97


def test_smoothing_a_range_joins_the_rest_without_a_step(take: Take) -> None:
    edited = smooth(take, (100, 200), 4.0).apply(take)
    np.testing.assert_array_equal(edited.weights[:100], take.weights[:100])
    np.testing.assert_array_equal(edited.weights[200:], take.weights[200:])
    usual = np.abs(np.diff(take.weights, axis=0)).max()
    assert np.abs(np.diff(edited.weights[98:103], axis=0)).max() <= usual


@pytest.mark.parametrize("cutoff_hz", [0.0, -1.0, 30.0, 1e9, float("nan")])
def test_a_cutoff_that_no_filter_has_is_refused(take: Take, cutoff_hz: float) -> None:
    with pytest.raises(EditError):
        smooth(take, (0, 10), cutoff_hz)


@pytest.mark.parametrize("frames", [1, 2, 3, 5])
def test_very_short_takes_are_smoothed_or_left(frames: int) -> None:
    take = Take(weights=np.full((frames, 52), 0.25), fps=30.0)
    np.testing.assert_allclose(smooth(take, (0, frames), 5.0).weights, 0.25)


@pytest.mark.parametrize("frames", [1, 2, 5, 50])
def test_what_is_pasted_is_met_and_the_feather_lies_outside(take: Take, frames: int) -> None:
    copied = take.weights[10 : 10 + frames]
    edited = paste(take, 200, copied).apply(take)
    np.testing.assert_array_equal(edited.weights[200 : 200 + frames], copied)
    for step, before in ((199, 198), (200 + frames, 201 + frames)):  # beside it the take is led over
        assert np.abs(edited.weights[step] - take.weights[step]).max() > 0.01
        assert (
            np.abs(edited.weights[step] - take.weights[step]).mean()
            > np.abs(edited.weights[before] - take.weights[before]).mean()
        )
    reach = round(PASTE_FEATHER_S * take.fps)
    np.testing.assert_array_equal(edited.weights[: 200 - reach], take.weights[: 200 - reach])
    np.testing.assert_array_equal(edited.weights[200 + frames + reach :], take.weights[200 + frames + reach :])


def test_pasting_a_stretch_over_itself_changes_nothing(take: Take) -> None:
    np.testing.assert_array_equal(paste(take, 100, take.weights[100:120]).apply(take).weights, take.weights)


def test_what_does_not_fit_is_left_out(take: Take) -> None:
    edited = paste(take, 290, take.weights[10:60]).apply(take)
    np.testing.assert_array_equal(edited.weights[290:], take.weights[10:20])
    with pytest.raises(EditError):
        paste(take, 300, take.weights[10:60])


def test_a_weight_is_kept_within_its_range_and_others_as_they_are(take: Take) -> None:
    patch = replace_weight(take, JAW, 50, np.linspace(-1, 2, 20))
    assert patch.weights[:, JAW].min() == 0.0 and patch.weights[:, JAW].max() == 1.0
    others = np.arange(52) != JAW
    np.testing.assert_array_equal(patch.weights[:, others], take.weights[50:70][:, others])
