"""Storage of a fill's request as JSON values, so that a project can repeat the fill exactly."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from engine.errors import EditError
from engine.pose import filled
from engine.speech.visemes import Cue
from engine.take import SHAPES, Array, Take

if TYPE_CHECKING:
    from engine.pose import Pose

REACH_S = 3.0  # seconds of a guide stored on either side of the span; a fill uses two
MAX_FRAMES = 1_000_000
MAX_SEED = 2**31 - 1
GONE = EditError("This fill does not say what it was made from.", "Fill the span anew.")
Frames = tuple[int, int]


@dataclass(frozen=True)
class Field:
    """The storage of one field of a request: `encode` turns its value into JSON values, `decode` turns them back."""

    encode: Callable[[Any], Any]
    decode: Callable[[Any], Any]


def _spans(spans: Any) -> tuple[Frames, ...]:
    return tuple(_span(span) for span in spans)


def _poses(pins: Mapping[int, Pose]) -> dict[str, dict[str, float]]:
    named = {frame: zip(SHAPES, filled(pose).tolist(), strict=True) for frame, pose in pins.items()}
    return {str(frame): {name: value for name, value in pose if np.isfinite(value)} for frame, pose in named.items()}


def _pins(stored: Any) -> dict[int, dict[str, float]]:
    return {int(frame): {str(name): float(value) for name, value in pose.items()} for frame, pose in stored.items()}


def _curves(stored: Any) -> dict[str, Array | float]:
    if not isinstance(stored, Mapping):  # an older version stored the names alone
        raise GONE
    return {str(name): _curve(curve) for name, curve in stored.items()}


def _seed(stored: Any) -> int:
    return stored if isinstance(stored, int) and 0 <= stored <= MAX_SEED else 0


def _span(span: Any) -> Frames:
    start, stop = span
    return int(start), int(stop)


def _numbers(curve: Array | float) -> list[float | None] | float:
    values = np.asarray(curve, np.float64)
    if values.ndim == 0:
        return float(values)
    return [value if np.isfinite(value) else None for value in values.tolist()]


def _curve(values: Any) -> Array | float:
    if isinstance(values, int | float):
        return float(values)
    return np.array([np.nan if value is None else float(value) for value in values])


def stored_guide(guide: Take | None, frames: Frames) -> dict[str, Any]:
    """Return the part of a guide that a fill of its `frames` uses, as JSON values, since its file may change or vanish."""
    if guide is None:
        return {"guide": "", "guide_frames": None}
    reach = round(REACH_S * guide.fps)
    first, last = max(0, frames[0] - reach), min(len(guide), frames[1] + reach)
    rows = np.ascontiguousarray(guide.weights[first:last], "<f8")
    lost = np.flatnonzero(guide.lost[first:last]).tolist()
    packed = base64.b64encode(rows.tobytes()).decode("ascii")
    known = {"fps": guide.fps, "frames": len(guide), "first": first, "weights": packed, "lost": lost}
    return {"guide": guide.name, "guide_frames": known}


def guide_of(inputs: Mapping[str, Any]) -> Take | None:
    """Return a guide of the stored one's length; far from the span its weights are zero."""
    stored = inputs["guide_frames"]
    if stored is None:
        if inputs["guide"]:
            raise GONE
        return None
    rows = np.frombuffer(base64.b64decode(stored["weights"], validate=True), "<f8").reshape(-1, len(SHAPES))
    frames, first = int(stored["frames"]), int(stored["first"])
    if not 0 <= first < first + len(rows) <= frames <= MAX_FRAMES:
        raise GONE
    weights, lost = np.zeros((frames, len(SHAPES))), np.zeros(frames, bool)
    weights[first : first + len(rows)] = rows
    lost[first + np.array(stored["lost"], np.int64)] = True
    return Take(weights, float(stored["fps"]), lost, name=str(inputs["guide"]))


def _visemes(stored: Any) -> tuple[Cue, ...]:
    return tuple(Cue(float(start), float(stop), str(label)) for start, stop, label in stored)


FIELDS: dict[str, Field] = {  # of a request, all but its guide
    "frames": Field(list, _span),
    "region": Field(str, str),
    "pins": Field(_poses, _pins),
    "guide_offset": Field(int, int),
    "visemes": Field(lambda cues: [[cue.start_s, cue.stop_s, cue.label] for cue in cues], _visemes),
    "controls": Field(lambda curves: {name: _numbers(curve) for name, curve in curves.items()}, _curves),
    "style": Field(str, str),
    "lost": Field(bool, bool),
    "besides": Field(lambda spans: [list(span) for span in spans], _spans),
    "unmade": Field(lambda spans: [list(span) for span in spans], _spans),
    "seed": Field(int, _seed),
}
FAULTS = (KeyError, TypeError, ValueError, AttributeError, OverflowError)  # raised by JSON that is no stored request
