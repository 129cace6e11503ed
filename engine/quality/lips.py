"""What lips do wrong: stay open where they should meet, leave the teeth on F and V, close further than the jaw opens."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from engine.anatomy import Indices
from engine.controls import CONTROL_INDEX
from engine.jaw import excess
from engine.quality.record import Flag, weight_of
from engine.quality.seen import Seen, lowest
from engine.quality.tuning import TUNING
from engine.speech.visemes import NAMES
from engine.take import Mask, runs

LIPS = CONTROL_INDEX["lips_vertical"]
_MBP, _FV = NAMES.index("mbp"), NAMES.index("fv")


def stay_open(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield places where lips should meet and never do: M, B and P, and where they met before the edits."""
    lips = seen.controls[:, LIPS]
    spans, labels = _cues_of(seen, _MBP)
    for (start, stop), nearest, label in zip(spans.tolist(), lowest(lips, spans), labels, strict=True):
        if nearest > seen.tuning.closed_mm:
            text = f"The lips stay {nearest:.1f} mm apart where {label} is said."
            yield Flag("open", start, stop, weight_of(nearest, seen.tuning.closed_mm, seen.tuning.full_gap_mm), text)
    met = _met(seen)
    for (start, stop), nearest in zip(met.tolist(), lowest(lips, met), strict=True):
        if nearest > seen.tuning.closed_mm:
            text = f"The lips met here before the edits and now stay {nearest:.1f} mm apart."
            yield Flag("open", start, stop, weight_of(nearest, seen.tuning.closed_mm, seen.tuning.full_gap_mm), text)


def off_teeth(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield each F and V through which the lips stay too far apart for the lower one to touch the teeth."""
    spans, labels = _cues_of(seen, _FV)
    for (start, stop), nearest, label in zip(
        spans.tolist(), lowest(seen.controls[:, LIPS], spans), labels, strict=True
    ):
        if nearest > seen.tuning.teeth_mm:
            text = f"The lips stay {nearest:.1f} mm apart where {label} is said: the lip does not reach the teeth."
            yield Flag("teeth", start, stop, weight_of(nearest, seen.tuning.teeth_mm, seen.tuning.full_teeth_mm), text)


def close_above_jaw(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield frames on which mouthClose is above jawOpen: some characters press the lips through each other there."""
    beyond = excess(seen.weights[low:high])
    for start, stop in runs((beyond > seen.tuning.above_jaw) & seen.kept[low:high]):
        most = float(beyond[start:stop].max())
        text = f"mouthClose is {most:.2f} above jawOpen: on some characters the lips close too far."
        yield Flag(
            "close", low + start, low + stop, weight_of(most, seen.tuning.above_jaw, seen.tuning.full_above_jaw), text
        )


def _cues_of(seen: Seen, viseme: int) -> tuple[Indices, list[str]]:
    """Return the frames of a viseme's cues, (n, 2), within the take, and their labels."""
    lane = seen.visemes
    if lane is None:
        return np.zeros((0, 2), np.int64), []
    places = np.flatnonzero(lane.classes == viseme)
    frames = np.round(lane.times_s[places] * seen.fps).astype(np.int64)
    frames[:, 1] = np.maximum(frames[:, 1], frames[:, 0] + 1)
    frames = np.clip(frames, 0, seen.length)
    within = frames[:, 0] < frames[:, 1]
    return frames[within], [lane.cues[index].label for index in places[within]]


def _met(seen: Seen) -> Indices:
    """Return the frames, (n, 2), at which the lips met briefly before the edits and have no target since."""
    if seen.original_controls is None:
        return np.zeros((0, 2), np.int64)
    met = np.array(runs(seen.original_controls[:, LIPS] < TUNING.closed_mm), np.int64).reshape(-1, 2)
    settled: Mask = seen.lost if seen.asked is None else seen.lost | ~np.isnan(seen.asked[:, LIPS])
    before = np.append(0, np.cumsum(settled))
    free = before[met[:, 1]] == before[met[:, 0]]
    return np.asarray(met[free & (np.diff(met, axis=1)[:, 0] <= seen.tuning.brief_s * seen.fps)])
