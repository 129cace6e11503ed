"""Label files: how another head looks at a few frames of a take, as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from engine.errors import FormatError
from engine.formats.atomic import write_bytes
from engine.take import SHAPE_INDEX

MAX_BYTES = 16 << 20
EXPECTED = 'A label file reads {"target": "head.npz", "labels": [{"frame": 0, "weights": {"jawOpen": 0.5}}]}.'


@dataclass(frozen=True)
class Labels:
    """Poses of a head, weights by shape name, by frame; a shape that is not named is the source's.

    Attributes
    ----------
    target : path of the head, as the file has it; empty for the bundled one
    poses : by frame
    """

    target: str
    poses: Mapping[int, Mapping[str, float]]


def read(path: Path) -> Labels:
    """Read a label file; raises `FormatError` that says what it holds instead."""
    try:
        if path.stat().st_size > MAX_BYTES:
            raise FormatError(f"{path.name} is too large for a label file.", EXPECTED)
        stored = json.loads(path.read_text("utf-8"))
    except OSError as error:
        raise FormatError(f"{path.name} could not be read: {(error.strerror or 'unknown reason').lower()}.") from error
    except (ValueError, RecursionError) as error:
        raise FormatError(f"{path.name} is not JSON.", EXPECTED) from error
    if not isinstance(stored, dict) or not isinstance(stored.get("labels"), list):
        raise FormatError(f"{path.name} holds no list of labels.", EXPECTED)
    target = stored.get("target", "")
    if not isinstance(target, str):
        raise FormatError(f"{path.name} names no file for its target.", EXPECTED)
    poses: dict[int, Mapping[str, float]] = {}
    for number, entry in enumerate(stored["labels"], 1):
        frame, pose = _label(entry, number, path)
        if frame in poses:
            raise FormatError(f"{path.name} labels frame {frame} twice.")
        poses[frame] = pose
    return Labels(target, poses)


def _label(entry: Any, number: int, path: Path) -> tuple[int, Mapping[str, float]]:
    if not isinstance(entry, dict) or not isinstance(entry.get("weights"), dict):
        raise FormatError(f"{path.name} has no weights in label {number}.", EXPECTED)
    frame = entry.get("frame")
    if not isinstance(frame, int) or isinstance(frame, bool) or not 0 <= frame < 2**31:
        raise FormatError(f"{path.name} has no frame in label {number}.", EXPECTED)
    pose: dict[str, float] = {}
    for name, value in entry["weights"].items():
        if name not in SHAPE_INDEX:
            raise FormatError(f"{path.name} names no shape with {name[:40]!r} in label {number}.")
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise FormatError(f"{path.name} has no number for {name} in label {number}.")
        pose[name] = float(value)
    return frame, pose


def write(labels: Labels, path: Path) -> None:
    """Write a label file for `read`; raises `EngineError` when the folder cannot be written."""
    entries = [{"frame": frame, "weights": dict(labels.poses[frame])} for frame in sorted(labels.poses)]
    stored = json.dumps({"target": labels.target, "labels": entries}, indent=1)
    write_bytes(path, [stored.encode(), b"\n"])
