"""The laws of editing on every recorded take, where the recordings are at hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.controls import ALL_INDEX
from engine.editing import ControlRequest, Dragger, set_control
from engine.extended import bundled_face
from engine.formats import read_take
from engine.lab.corpus import data_folder
from engine.lab.performer.augment import MIRROR
from engine.take import Array, Take

LENGTH_S, AROUND_S = 0.8, 1.5  # of the edit, and of what is kept of the take around it
CHANGES = (("corner_left", 3.0), ("lips_horizontal", 4.0), ("lips_vertical", 4.0), ("eyelid_left", -3.0))
OPEN_MM = 5.0  # a lid that is nearer to shut than this cannot come 3 mm nearer


TAKES = sorted(path for path in data_folder().rglob("*.csv") if path.stem != "arkit_mapping")
pytestmark = pytest.mark.skipif(not TAKES, reason="the recorded takes are not here (RETAKE_DATA)")
every_take = pytest.mark.parametrize("path", TAKES, ids=lambda path: path.stem)
somewhere = pytest.mark.parametrize("share", [0.3, 0.7])


def _piece(path: Path, share: float) -> tuple[Take, tuple[int, int]]:
    """Return some seconds of a take at a share of its length, and the frames to edit in them."""
    take = read_take(path)
    around, length = round(AROUND_S * take.fps), round(LENGTH_S * take.fps)
    start = round(share * (len(take) - length))
    first, last = max(0, start - around), min(len(take), start + length + around)
    return Take(weights=take.weights[first:last], fps=take.fps), (start - first, start - first + length)


def _curve(take: Take, control: str, frames: tuple[int, int]) -> Array:
    return np.asarray(bundled_face().measure(take.weights[slice(*frames)])[:, ALL_INDEX[control]])


@every_take
@somewhere
def test_pulled_curves_go_there_come_back_and_stay(path: Path, share: float) -> None:
    take, frames = _piece(path, share)
    dragger = Dragger(take)
    still = dragger.drag(frames[0], dragger.controls[slice(*frames)])
    np.testing.assert_array_equal(still.weights, take.weights[still.start : still.stop])
    for control, by in CHANGES:
        before = _curve(take, control, frames)
        if by < 0 and before.min() < OPEN_MM:
            continue
        patch = set_control(take, ControlRequest(control, frames, "add", by))
        once = patch.apply(take)
        assert abs((_curve(once, control, frames) - before)[8:-8].mean() / by) >= 0.95, control
        asked = Dragger(once).controls[patch.start : patch.stop].copy()
        asked[:, ALL_INDEX[control]] = dragger.controls[patch.start : patch.stop, ALL_INDEX[control]]
        back = Dragger(once).drag(patch.start, asked).apply(once)
        assert np.abs(_curve(back, control, frames) - before).mean() <= 0.1, control
        value = float(before.mean() + by)
        one = set_control(take, ControlRequest(control, frames, "set", value)).apply(take)
        two = set_control(one, ControlRequest(control, frames, "set", value)).apply(one)
        again = np.abs(_curve(two, control, frames) - _curve(one, control, frames))
        assert again[8:-8].mean() <= 0.1, control


@every_take
@somewhere
def test_sides_and_rates_make_no_difference(path: Path, share: float) -> None:
    take, frames = _piece(path, share)
    mirror = take.with_weights(take.weights[:, MIRROR])
    for left, right in (("corner_left", "corner_right"), ("eyelid_left", "eyelid_right")):
        here = set_control(take, ControlRequest(left, frames, "add", -2.0)).apply(take)
        there = set_control(mirror, ControlRequest(right, frames, "add", -2.0)).apply(mirror)
        moved = np.abs(here.weights - take.weights).max()
        assert moved > 0, left
        assert np.abs(there.weights[:, MIRROR] - here.weights).max() <= 1e-6, left
    if take.fps > 45:
        take, frames = Take(weights=take.weights[frames[0] % 2 :], fps=take.fps), (frames[0] // 2, frames[1] // 2)
        half = Take(weights=take.weights[::2], fps=take.fps / 2)
        fine = (
            set_control(take, ControlRequest("lips_vertical", (2 * frames[0], 2 * frames[1]), "add", 5.0))
            .apply(take)
            .weights[::2]
        )
        coarse = set_control(half, ControlRequest("lips_vertical", frames, "add", 5.0)).apply(half).weights
        assert np.abs(fine - coarse).max() <= 0.1 * np.abs(fine - half.weights).max()
