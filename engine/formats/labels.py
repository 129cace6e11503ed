"""Labelled frames: how the target of a retarget stands at a few frames of the source, as JSON or CSV.

JSON: ``{"target": "anna.npz", "labels": [{"frame": 12, "weights": {"jawOpen": 0.4}}]}``; the target, a character's file
relative to the label file, may be left out. CSV: the columns frame and ARKit shapes, a row for each label; an empty
cell says nothing of its shape.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from engine.errors import FormatError
from engine.formats.base.atomic import write_bytes
from engine.formats.base.textfile import read_text
from engine.take import SHAPE_INDEX

EXPECTED = 'A label file is JSON: {"labels": [{"frame": 12, "weights": {"jawOpen": 0.4}}]}, or CSV: frame,jawOpen,...'
FARTHEST = 10.0  # a weight beyond this is a mistake, not a pose
LAST_FRAME = 10**9


@dataclass(frozen=True)
class LabelFile:
    """What a label file holds.

    Attributes
    ----------
    labels : weight by shape, by frame; a shape that is not named stays as the source has it
    target : the character's file, in the folder of the labels or below it; None where they name none, or one elsewhere
    elsewhere : the character's file as it was named, where it lies elsewhere; it is never opened for the asking of a file
    """

    labels: Mapping[int, Mapping[str, float]]
    target: Path | None = None
    elsewhere: str = ""


def read(path: Path) -> LabelFile:
    """Read labelled frames from a .json or .csv file; raises `FormatError` that names the label to blame."""
    text = read_text(path)
    target, rows = _csv(text, path) if path.suffix.lower() == ".csv" else _json(text, path)
    labels: dict[int, dict[str, float]] = {}
    for number, (frame, weights) in enumerate(rows, start=1):
        if isinstance(frame, bool) or not isinstance(frame, int) or not 0 <= frame <= LAST_FRAME:
            raise FormatError(f"{path.name} has no frame number in label {number}.", EXPECTED)
        if frame in labels:
            raise FormatError(f"{path.name} labels frame {frame} twice.", "Keep one of the two.")
        if not isinstance(weights, Mapping):
            raise FormatError(f"{path.name} has no weights in label {number}, frame {frame}.", EXPECTED)
        labels[frame] = {str(shape): _weight(str(shape), value, frame, path) for shape, value in weights.items()}
    if not labels:
        raise FormatError(f"{path.name} labels no frame.", EXPECTED)
    beside = None if target is None else _beside(target, path)
    return LabelFile(labels, beside, target if target is not None and beside is None else "")


def write(file: LabelFile, path: Path) -> None:
    """Write labelled frames as JSON; an existing file is replaced whole or left as it was."""
    rows = [{"frame": frame, "weights": dict(weights)} for frame, weights in sorted(file.labels.items())]
    stored: dict[str, Any] = {} if file.target is None else {"target": file.target.as_posix()}
    write_bytes(path, [json.dumps({**stored, "labels": rows}, indent=1).encode()])


def _weight(shape: str, value: Any, frame: int, path: Path) -> float:
    if shape not in SHAPE_INDEX:
        raise FormatError(
            f"{path.name} names {shape[:40]!r} at frame {frame}, which is no shape.",
            "Shapes have ARKit names, such as jawOpen.",
        )
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not -FARTHEST <= value <= FARTHEST:
        raise FormatError(f"{path.name} gives {shape} no usable weight at frame {frame}.", "Weights lie in 0..1.")
    return float(value)


def _json(text: str, path: Path) -> tuple[str | None, Iterable[tuple[Any, Any]]]:
    try:
        stored = json.loads(text)
        target, rows = stored.get("target"), [(row["frame"], row["weights"]) for row in stored["labels"]]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError, OverflowError, MemoryError):
        raise FormatError(f"{path.name} is not a list of labelled frames.", EXPECTED) from None
    if target is not None and (not isinstance(target, str) or not target or "\0" in target):
        raise FormatError(f"{path.name} names a target that is not a file's name.", EXPECTED)
    return target, rows


def _beside(target: str, path: Path) -> Path | None:
    """Return the character that a label file names, where it lies in its folder or below; else None.

    Whoever wrote the file may know of other folders: it is not for him to say what is opened there.
    """
    named = target.replace("\\", "/")
    leads_out = named.startswith("/") or ":" in named.split("/")[0] or ".." in named.split("/")
    try:
        found = path.parent / named
        inside = not leads_out and found.resolve().is_relative_to(path.parent.resolve())
    except (OSError, ValueError, RuntimeError):
        inside = False
    return found if inside else None


def _csv(text: str, path: Path) -> tuple[None, Iterable[tuple[Any, Any]]]:
    lines = [[cell.strip() for cell in line.split(",")] for line in text.splitlines() if line.strip()]
    if not lines or lines[0][0].lower() != "frame" or len(set(lines[0])) < len(lines[0]):
        raise FormatError(f"{path.name} does not begin with the row frame and the names of shapes.", EXPECTED)
    rows = []
    for number, cells in enumerate(lines[1:], start=2):
        if len(cells) != len(lines[0]):
            raise FormatError(f"{path.name} has {len(cells)} cells in row {number}, its first row {len(lines[0])}.")
        frame = int(cells[0]) if cells[0].isascii() and cells[0].isdigit() and len(cells[0]) < 12 else None
        rows.append((frame, {name: _number(cell) for name, cell in zip(lines[0][1:], cells[1:], strict=True) if cell}))
    return None, rows


def _number(cell: str) -> float | str:
    try:
        return float(cell)
    except ValueError:
        return cell
