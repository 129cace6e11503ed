"""Cleaning against filters and memoryless learners, at 30, 60, 120 and a changing frame rate (BSS20b tables 1 and 2)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from engine.clean.infer import bundled
from engine.clean.lag import lag_ms
from engine.clean.takes import run
from engine.controls import CONTROL_INDEX, bundled_measurer, measure
from engine.lab.corpus import SHORTEST, TEST, data_folder, load_takes
from engine.lab.evaluate.clean.baselines import Filter, exponential, gaussian, raw
from engine.lab.performer.degrade import Tracked
from engine.lab.reporting import Report, Row
from engine.lab.train.clean.material import CHANGING, Spoilt, spoil
from engine.lab.train.clean.tuning import load_rivals
from engine.take import SHAPES, Array, Mask, runs

RATES_FPS = (30.0, 60.0, 120.0, CHANGING)
LOOKS_AHEAD = {"gaussian_1", "gaussian_5", "savgol"}
LIPS_CLOSED_MM = 3.0
LID_CLOSED_SHARE = 1 / 3  # of the eye's opening at rest
LONGEST_BLINK_S = 0.6  # eyes shut for longer are shut, not blinking
RESTING_PER_S = 0.05  # a truth slower than this rests: what moves there is jitter
SEEDS = (7, 8, 9)  # every take is spoilt this often, since the luck of lost runs weighs more than the methods do


def table(data: Path | None, report: Report) -> list[Row]:
    """Return a row for each method and rate; `fps` 0 is a rate that changes.

    The takes are spoilt by a simulated tracker, always alike, and what each method makes of them is compared with the
    takes as they were. `mse` and the recalls count lost frames too.
    """
    takes = performances(data)
    methods = methods_by_name()
    rows = []
    for fps in RATES_FPS:
        spoilt = [item for seed in SEEDS for item in spoil(takes, fps, seed=seed)]
        for name, method in methods.items():
            result = [method(item.tracked, item.times_s) for item in spoilt]
            row: Row = {
                "method": name,
                "fps": int(fps),
                **figures_of(spoilt, result),
                "looks_ahead": name in LOOKS_AHEAD,
            }
            rows.append(row)
        report(f"{'changing rate' if fps == CHANGING else f'{fps:g} fps'}: {len(methods)} methods")
    return rows


def performances(data: Path | None) -> list[tuple[Array, float, str]]:
    """Return unbroken stretches of the test takes, or of every take in a folder: weights 0..1, their rate, their name."""
    found = []
    for take, _ in load_takes(data or data_folder()):
        if data is None and Path(take.name).stem not in TEST:
            continue
        for start, stop in runs(~take.lost):
            if stop - start >= SHORTEST:
                found.append((np.clip(take.weights[start:stop], 0.0, 1.0), take.fps, Path(take.name).stem))
    return found


def methods_by_name() -> dict[str, Filter]:
    """Return every row's method, ours first."""
    rivals = load_rivals()
    return {
        "lstm": lstm,
        "raw": raw,
        **{f"exponential_{share}": exponential(share) for share in (0.3, 0.5, 0.8)},
        **{f"gaussian_{sigma}": gaussian(sigma) for sigma in (1, 5)},
        **{name: rivals[name] for name in ("one_euro", "savgol", "kalman", "fully_connected", "boosted_trees")},
    }


def lstm(tracked: Tracked, times_s: Array) -> Array:
    """Return what the network that ships makes of it, as a live stream would show it."""
    return run(tracked.weights, tracked.lost, times_s, bundled())


def figures_of(spoilt: list[Spoilt], result: list[Array]) -> dict[str, Any]:
    """Return the metrics over all performances; frames count alike, whichever take they are of."""
    pairs = list(zip(spoilt, result, strict=True))
    blinks = np.sum([events(item.truth, each, item.times_s, _blinking) for item, each in pairs], axis=0)
    closures = np.sum([events(item.truth, each, item.times_s, _lips_closed) for item, each in pairs], axis=0)
    lags = [lag_ms(each, item.truth, item.times_s) for item, each in pairs]
    seconds = sum(float(item.times_s[-1] - item.times_s[0]) for item in spoilt)
    return {
        "mse": _mean([np.square(each - item.truth) for item, each in pairs]),
        "velocity_error": _mean([np.abs(_velocity(each, item) - _velocity(item.truth, item)) for item, each in pairs]),
        "jitter": float(np.sqrt(np.concatenate([_jitter(each, item) for item, each in pairs]).mean())),
        "blink_recall": _share(blinks[1], blinks[0]),
        "closure_recall": _share(closures[1], closures[0]),
        "lag_ms": float(np.nanmean(lags)) if np.isfinite(lags).any() else float("nan"),
        "false_blinks_per_min": float(blinks[2]) / seconds * 60,
    }


def events(truth: Array, result: Array, times_s: Array, closed: Any) -> tuple[int, int, int]:
    """Return how many closures the truth has, how many of them are found, and how many are found that are not there.

    A closure is found when half of its frames are closed; one that meets none of the truth's is false.
    """
    true, seen = closed(truth, times_s), closed(result, times_s)
    found = sum(seen[start:stop].mean() >= 0.5 for start, stop in runs(true))
    false = sum(not true[start:stop].any() for start, stop in runs(seen))
    return len(runs(true)), int(found), int(false)


def _blinking(weights: Array, times_s: Array) -> Mask:
    """Frames on which both eyes are shut for no longer than a blink lasts."""
    columns = [CONTROL_INDEX["eyelid_right"], CONTROL_INDEX["eyelid_left"]]
    rest = bundled_measurer().measure(np.zeros((1, len(SHAPES))))[0, columns]
    shut: Mask = np.all(measure(weights)[:, columns] < LID_CLOSED_SHARE * rest, axis=1)
    for start, stop in runs(shut):
        if times_s[stop - 1] - times_s[start] > LONGEST_BLINK_S:
            shut[start:stop] = False
    return shut


def _lips_closed(weights: Array, times_s: Array) -> Mask:
    return np.asarray(measure(weights)[:, CONTROL_INDEX["lips_vertical"]] < LIPS_CLOSED_MM)


def _velocity(weights: Array, item: Spoilt) -> Array:
    return np.diff(weights, axis=0) / np.diff(item.times_s)[:, None]


def _jitter(result: Array, item: Spoilt) -> Array:
    """Return squared second differences where the truth rests and shows something."""
    rests = np.abs(_velocity(item.truth, item)) < RESTING_PER_S
    rests = rests[1:] & rests[:-1] & (item.truth[1:-1] > 0.02)
    return np.square(np.diff(result, n=2, axis=0))[rests]


def _mean(parts: list[Array]) -> float:
    return float(np.concatenate([part.ravel() for part in parts]).mean())


def _share(part: int, whole: int) -> float | None:
    return float(part / whole) if whole else None
