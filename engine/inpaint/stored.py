"""A fill's request as JSON can hold it, so that a project can make the very same motion again."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

from engine.errors import EditError
from engine.inpaint.request import Frames, Request, Style
from engine.speech.visemes import Cue
from engine.take import SHAPES, Array, Take

REACH_S = 3.0  # of a guide on either side of the span that is kept; a fill looks two seconds far
MAX_FRAMES = 1_000_000
GONE = EditError("This fill does not say what it was made from.", "Fill the span anew.")


def stored(request: Request) -> dict[str, Any]:
    """Return all that a request says; a guide by its frames around the span, since its file may change or vanish."""
    pins = {
        str(frame): {name: value for name, value in zip(SHAPES, pose.tolist(), strict=True) if np.isfinite(value)}
        for frame, pose in request.poses().items()
    }
    return {
        "frames": list(request.frames),
        "region": request.region,
        "pins": pins,
        "controls": {name: _numbers(curve) for name, curve in request.controls.items()},
        "guide": request.guide.name if request.guide is not None else "",
        "guide_frames": None if request.guide is None else _guide(request, request.guide),
        "guide_offset": request.guide_offset,
        "visemes": [[cue.start_s, cue.stop_s, cue.label] for cue in request.visemes],
        "style": request.style,
        "lost": request.lost,
        "besides": [list(span) for span in request.besides],
        "unmade": [list(span) for span in request.unmade],
    }


def restored(inputs: Mapping[str, Any]) -> Request:
    """Return the request that `stored` made this from; raises `EditError` for anything else."""
    try:
        controls = inputs["controls"]
        if not isinstance(controls, Mapping):  # as written before the values were kept
            raise GONE
        return Request(
            frames=_span(inputs["frames"]),
            region=str(inputs["region"]),
            pins={int(frame): {str(k): float(v) for k, v in pose.items()} for frame, pose in inputs["pins"].items()},
            guide=_guide_of(inputs),
            guide_offset=int(inputs["guide_offset"]),
            visemes=tuple(Cue(float(start), float(stop), str(label)) for start, stop, label in inputs["visemes"]),
            controls={str(name): _curve(curve) for name, curve in controls.items()},
            style=cast(Style, str(inputs["style"])),
            lost=bool(inputs["lost"]),
            besides=tuple(_span(span) for span in inputs["besides"]),
            unmade=tuple(_span(span) for span in inputs["unmade"]),
        )
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise GONE from error


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


def _guide(request: Request, guide: Take) -> dict[str, Any]:
    reach = round(REACH_S * guide.fps)
    first = max(0, request.frames[0] + request.guide_offset - reach)
    last = min(len(guide), request.frames[1] + request.guide_offset + reach)
    rows = np.ascontiguousarray(guide.weights[first:last], "<f8")
    return {
        "fps": guide.fps,
        "frames": len(guide),
        "first": first,
        "weights": base64.b64encode(rows.tobytes()).decode("ascii"),
        "lost": np.flatnonzero(guide.lost[first:last]).tolist(),
    }


def _guide_of(inputs: Mapping[str, Any]) -> Take | None:
    """Return a guide as long as the one that was used; what lies far from the span is a face at rest."""
    kept = inputs["guide_frames"]
    if kept is None:
        if inputs["guide"]:
            raise GONE
        return None
    rows = np.frombuffer(base64.b64decode(kept["weights"], validate=True), "<f8").reshape(-1, len(SHAPES))
    frames, first = int(kept["frames"]), int(kept["first"])
    if not 0 <= first < first + len(rows) <= frames <= MAX_FRAMES:
        raise GONE
    weights, lost = np.zeros((frames, len(SHAPES))), np.zeros(frames, bool)
    weights[first : first + len(rows)] = rows
    lost[first + np.array(kept["lost"], np.int64)] = True
    return Take(weights, float(kept["fps"]), lost, name=str(inputs["guide"]))
