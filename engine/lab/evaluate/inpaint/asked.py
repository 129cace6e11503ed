"""Whether what is asked for appears: real bilabials, blinks and smiles are masked and filled again from one pin or viseme."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from engine.controls import CONTROL_INDEX, bundled_measurer
from engine.inpaint.gap import Gap, gap_of
from engine.inpaint.infer import bundled
from engine.inpaint.regions import REGIONS
from engine.inpaint.seams import bridge_weights
from engine.lab.corpus import Piece, pieces_to_measure
from engine.lab.evaluate.inpaint.motion import CLOSED_MM
from engine.lab.evaluate.inpaint.table import Method
from engine.lab.reporting import Report, Row
from engine.speech.visemes import NAMES
from engine.take import MODEL_FPS, SHAPE_INDEX, Array, Mask, runs

AROUND = 12  # frames masked on either side of an event
LONGEST_S = {"bilabial": 0.25, "blink": 0.5, "smile": 4.0}
SMILE = 0.4
MOST = 60
_SMILES = [SHAPE_INDEX["mouthSmileLeft"], SHAPE_INDEX["mouthSmileRight"]]


@dataclass(frozen=True, eq=False)
class Event:
    """Something that happens in a piece over the frames [start, stop), deepest at `peak`."""

    kind: str
    weights: Array
    start: int
    stop: int
    peak: int


def _signal(kind: str, weights: Array) -> Array:
    """Return a curve, (frames,), that is below zero while the event lasts."""
    measured = bundled_measurer().measure(weights)
    if kind == "bilabial":
        return np.asarray(measured[:, CONTROL_INDEX["lips_vertical"]] - CLOSED_MM)
    if kind == "blink":
        lids = measured[:, [CONTROL_INDEX["eyelid_right"], CONTROL_INDEX["eyelid_left"]]]
        return np.asarray(lids.max(axis=1) - CLOSED_MM)
    return np.asarray(SMILE - weights[:, _SMILES].mean(axis=1))


def events(pieces: Sequence[Piece], kind: str) -> list[Event]:
    """Return events of a kind with room around them, evenly spread where there are more than `MOST`."""
    found = []
    for piece in pieces:
        if kind != "bilabial" and not piece.whole_face:
            continue
        signal = _signal(kind, piece.weights)
        for start, stop in runs(signal < 0):
            room = start - AROUND >= 10 and stop + AROUND + 10 <= len(signal)
            if room and stop - start <= LONGEST_S[kind] * MODEL_FPS:
                peak = start + int(np.argmin(signal[start:stop]))
                found.append(Event(kind, piece.weights, start, stop, peak))
    chosen: list[int] = np.unique(np.linspace(0, len(found) - 1, MOST).round().astype(int)).tolist() if found else []
    return [found[index] for index in chosen]


def masked(event: Event, steering: str) -> tuple[Gap, slice]:
    """Return the gap around an event with nothing, one pin at its peak or its viseme; and the event's own frames."""
    first, last = max(0, event.start - 72), min(len(event.weights), event.stop + 72)
    known = np.array(event.weights[first:last])
    hole: Mask = np.zeros(known.shape, bool)
    region = REGIONS["eyes" if event.kind == "blink" else "lower"]
    hole[event.start - AROUND - first : event.stop + AROUND - first, region] = True
    pinned = hole[event.peak - first] & (steering == "pin")
    known[hole] = np.nan
    known[event.peak - first, pinned] = event.weights[event.peak, pinned]
    visemes = np.zeros((len(known), len(NAMES)))
    if steering == "viseme":
        visemes[event.start - first : event.stop - first, NAMES.index("mbp")] = 1.0
    return gap_of(known, visemes=visemes), slice(event.start - first, event.stop - first)


def table(data: Path | None, report: Report) -> list[Row]:
    """Return the share of events that happen again, per kind, steering and method."""
    pieces = pieces_to_measure(data)
    ways: dict[str, Method] = {
        "gan": lambda gap: bundled().fill(gap)[0],
        "bridge": lambda gap: bridge_weights(gap.known),
    }
    rows = []
    for kind in LONGEST_S:
        found = events(pieces, kind)
        for steering in ("none", "pin", *(["viseme"] if kind == "bilabial" else [])):
            gaps = [masked(event, steering) for event in found]
            for name, make in ways.items():
                happened = [(_signal(kind, make(gap))[inside] < 0.02).mean() for gap, inside in gaps]
                rows.append(
                    {
                        "method": name,
                        "event": kind,
                        "steering": steering,
                        "count": len(found),
                        "rate": float(np.mean(np.array(happened) > 0)) if found else np.nan,
                        "share_of_frames": float(np.mean(happened)) if found else np.nan,
                    }
                )
        report(f"{kind}: {len(found)} events")
    return rows
