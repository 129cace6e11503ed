"""Retargeting to a second head and back, where the truth is known: movement matching against per-frame methods (SLS12)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from engine.character import Character, bundled
from engine.jaw import drawable
from engine.lab.corpus import Piece, data_folder, pieces_to_measure
from engine.lab.evaluate.spacetime import second_head as ict
from engine.lab.evaluate.spacetime.baselines import RANGE, per_frame, per_frame_bounded, per_frame_prior
from engine.lab.reporting import Report, Row
from engine.spacetime.closure import Gaps
from engine.spacetime.layout import Layout, standard
from engine.spacetime.matching import Matching
from engine.spacetime.retarget import Correspondence, correspond, match, with_jaw, without_jaw
from engine.spacetime.source import Source, from_take, without_jitter
from engine.take import MODEL_FPS, Array, Mask, Take

PRIOR_ALPHA = 0.3  # of the per-frame prior, chosen on training takes as our own settings were
CLOSED_MM = 3.0
METHODS: dict[str, Callable[[Correspondence], Array]] = {
    "movement_matching": lambda pair: match(pair, MODEL_FPS, Matching()),
    "movement_matching_free": lambda pair: match(pair, MODEL_FPS, replace(Matching(), bounds=None)),
    "per_frame": per_frame,
    "per_frame_bounded": lambda pair: without_jaw(pair, per_frame_bounded(with_jaw(pair), 0.0, 1.0)),
    "per_frame_bounded_paper": lambda pair: per_frame_bounded(pair, *RANGE),
    "per_frame_prior": lambda pair: per_frame_prior(pair, PRIOR_ALPHA),
}
STRETCH = np.array([1.0, 1.3, 1.0])  # the proportion change: a face 1.3 times as long
NOISE_MM = 1.0
GAP_SHARE, GAP_FRAMES = 0.1, 10.0
SEED = 0


def _clean(source: Source, rng: np.random.Generator) -> Source:
    del rng
    return source


def _noisy(source: Source, rng: np.random.Generator) -> Source:
    noise = NOISE_MM * rng.standard_normal(source.displacements.shape)
    return replace(source, displacements=source.displacements + noise)


def _gappy(source: Source, rng: np.random.Generator) -> Source:
    """Hide runs of frames, ten on average, of single markers, a tenth of everything."""
    frames, markers = source.displacements.shape[:2]
    hidden = np.zeros((frames, markers), bool)
    state: Mask = np.asarray(rng.random(markers) < GAP_SHARE)
    leave, enter = 1 / GAP_FRAMES, GAP_SHARE / (1 - GAP_SHARE) / GAP_FRAMES
    for frame in range(frames):
        state = np.where(state, rng.random(markers) >= leave, rng.random(markers) < enter)
        hidden[frame] = state
    return replace(source, displacements=np.where(hidden[..., None], np.nan, source.displacements))


def _stretched(source: Source, rng: np.random.Generator) -> Source:
    del rng
    return replace(source, displacements=source.displacements * STRETCH, neutral=source.neutral * STRETCH)


CONDITIONS: dict[str, Callable[[Source, np.random.Generator], Source]] = {
    "clean": _clean,
    "noise_1mm": _noisy,
    "gaps_10pct": _gappy,
    "proportion_1.3": _stretched,
}


@dataclass(frozen=True, eq=False)
class Head:
    """A character with its markers and the gaps between its lips and lids."""

    character: Character
    layout: Layout
    gaps: Gaps


@lru_cache(maxsize=1)
def heads() -> tuple[Head, Head]:
    """Return the bundled head and the second one; raises `AssetError` without the data."""
    ours = bundled()
    other = ict.load(data_folder())
    return Head(ours, standard(ours), Gaps(ours)), Head(other, ict.layout(other, ours), Gaps(other))


def table(data: Path | None, report: Report) -> list[Row]:
    """Return rows of each method under each condition.

    A take is played on the bundled head, its markers are disturbed as the condition says and carried to the ICT head;
    the markers of that are carried back. `velocity_error` (mm per frame) and `position_error` (mm) compare markers
    after the round trip with the undisturbed ones, root mean square; `velocity_error_there` is the paper's figure 11:
    markers on the second head against the undisturbed source, in its proportions. `weight_overshoot` is the share of
    weights, both ways, outside -0.5..1.5; `closure_missed` the share of the source's closed lips and lids that are
    more than 3 mm apart after the trip, `closure_missed_there` the same on the second head.
    """
    takes = pieces_to_measure(data)
    rows: list[Row] = []
    for condition in CONDITIONS:
        for name, method in METHODS.items():
            report(f"{condition}: {name}")
            rows.append({"method": name, "condition": condition, **measure(takes, method, condition)})
    return rows


def measure(takes: list[Piece], method: Callable[[Correspondence], Array], condition: str) -> dict[str, float]:
    """Return the metrics of one method under one condition over all takes."""
    rng = np.random.default_rng(SEED)
    trips = [_round_trip(piece, method, condition, rng) for piece in takes]
    sums = {name: float(np.sum([trip[name] for trip in trips])) for name in trips[0]}
    return {
        "velocity_error": float(np.sqrt(sums["velocity"] / sums["steps"])),
        "position_error": float(np.sqrt(sums["position"] / sums["places"])),
        "velocity_error_there": float(np.sqrt(sums["velocity_there"] / sums["steps"])),
        "weight_overshoot": sums["outside"] / sums["weights"],
        "closure_missed": sums["missed"] / max(sums["closed"], 1.0),
        "closure_missed_there": sums["missed_there"] / max(sums["closed"], 1.0),
        "weight_error": sums["weight_error"] / sums["weights_back"],
    }


def _round_trip(
    piece: Piece, method: Callable[[Correspondence], Array], condition: str, rng: np.random.Generator
) -> dict[str, float]:
    ours, other = heads()
    truth = drawable(piece.weights)
    played = from_take(Take(truth, MODEL_FPS), ours.character, ours.layout)
    captured = CONDITIONS[condition](played, rng)
    captured = replace(
        captured, displacements=without_jitter(captured.displacements)
    )  # as any capture, for all methods
    there, used = carry(captured, other, method)
    undisturbed = _stretched(played, rng) if condition.startswith("proportion") else played
    in_source = used.basis @ there[:, used.shapes].T
    markers_there = in_source.T.reshape(played.displacements.shape)
    home = from_take(Take(there, MODEL_FPS), other.character, other.layout)
    back, used_back = carry(home, ours, method)
    after = back @ ours.layout.deltas(ours.character).reshape(truth.shape[1], -1)
    error = after.reshape(played.displacements.shape) - played.displacements
    closed = ours.gaps.sizes(truth) < CLOSED_MM
    weights = np.concatenate([there[:, used.shapes].ravel(), back[:, used_back.shapes].ravel()])
    away = np.abs(back - truth)[:, used_back.shapes]
    return {
        "velocity": float((np.diff(error, axis=0) ** 2).sum()),
        "velocity_there": float((np.diff(markers_there - undisturbed.displacements, axis=0) ** 2).sum()),
        "position": float((error**2).sum()),
        "places": float(error[..., 0].size),
        "steps": float(error[1:, :, 0].size),
        "outside": float(((weights < RANGE[0]) | (weights > RANGE[1])).sum()),
        "weights": float(weights.size),
        "closed": float(closed.sum()),
        "missed": float((closed & (ours.gaps.sizes(drawable(back)) >= CLOSED_MM)).sum()),
        "missed_there": float((closed & (other.gaps.sizes(drawable(there)) >= CLOSED_MM)).sum()),
        "weight_error": float(away.sum()),
        "weights_back": float(away.size),
    }


def carry(source: Source, head: Head, method: Callable[[Correspondence], Array]) -> tuple[Array, Correspondence]:
    """Return weights that play a source on a head, (frames, 52), and the correspondence that they were found by."""
    pair = correspond(source, head.character, head.layout)
    weights = source.take.weights.copy()
    weights[:, pair.shapes] = method(pair)
    return weights, pair
