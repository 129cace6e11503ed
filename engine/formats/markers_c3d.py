"""Markers as C3D, through the optional ezc3d; a marker with a negative residual or at exactly 0, 0, 0 is a gap."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

from engine.errors import FormatError
from engine.formats.capture import TO_MM, Markers
from engine.formats.content import require_file, unread
from engine.words import counted

EXPECTED = "Retake reads C3D files with labelled points."
HEADER_BYTES = 512
SMALLEST_POINT = 8  # bytes: four 16-bit numbers


def read(path: Path, *, unit: str | None = None, fps: float | None = None) -> Markers:
    """Read a C3D file's points. Parameters and errors as `markers.read`; says so where ezc3d is not installed."""
    _check_sizes(path)
    content = _parsed(path)
    points = content["parameters"]["POINT"]
    labels = tuple(str(label).strip() for label in points["LABELS"]["value"])
    data = np.asarray(content["data"]["points"], dtype=np.float64)  # (4, n, frames)
    positions = np.ascontiguousarray(data[:3].transpose(2, 1, 0))
    labels = labels[: positions.shape[1]]
    if len(labels) != positions.shape[1] or not labels or not len(positions):
        raise FormatError(
            f"{path.name} holds {counted(positions.shape[1], 'point')} but names {len(labels)}.", EXPECTED
        )
    residuals = np.asarray(content["data"]["meta_points"]["residuals"]).reshape(-1, data.shape[1], data.shape[2])[0].T
    gap = ~np.isfinite(positions).all(axis=2) | (residuals < 0) | (positions == 0).all(axis=2)
    positions[gap] = np.nan
    said = next((str(value).strip().lower() for value in points.get("UNITS", {}).get("value", [])), "mm")
    scale = TO_MM.get(unit or said)
    if scale is None:
        raise FormatError(f"{path.name} is in the unit {said[:20]!r}.", "Retake reads mm, cm and m.")
    return Markers(positions * scale, labels, fps or float(points["RATE"]["value"][0]), path.name)


def _check_sizes(path: Path) -> None:
    """Compare what the header declares with the size of the file, before a parser allocates it."""
    require_file(path)
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            header = file.read(HEADER_BYTES)
    except OSError as error:
        raise unread(path, error) from error
    if len(header) < HEADER_BYTES or header[1] != 0x50:
        raise FormatError(f"{path.name} is not a C3D file.", EXPECTED)
    points, _, first, last = struct.unpack_from("<HHHH", header, 2)
    if points * max(0, last - first + 1) * SMALLEST_POINT > size:
        raise FormatError(f"{path.name} declares more points than it holds.", "The file may be cut off or damaged.")


def _parsed(path: Path) -> Any:
    try:
        import ezc3d
    except ImportError:
        raise FormatError(
            f"{path.name} is a C3D file, and the reader for it is not installed.",
            "Install it with: pip install 'retake[c3d]', or export the markers as TRC or CSV.",
        ) from None
    try:
        return ezc3d.c3d(str(path))
    except Exception as error:  # a foreign parser's complaint, whatever its kind, is about the file
        raise FormatError(f"{path.name} could not be read as C3D.", EXPECTED) from error
