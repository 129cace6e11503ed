"""Markers as C3D, through the optional ezc3d; a marker with a negative residual or at exactly 0, 0, 0 is a gap."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

from engine.errors import FormatError
from engine.formats.capture import CAPTURE_BUDGET, TO_MM, Markers, each_once
from engine.formats.content import require_file, unread

EXPECTED = "Retake reads C3D files with labelled points."
HEADER_BYTES = 512
SGI = 86  # its number among the processors, INTEL 84 and DEC 85
MOST_LISTS = 64  # of labels: 16,000 points
SMALLEST_POINT = 8  # bytes: four 16-bit numbers


def read(path: Path, *, unit: str | None = None, fps: float | None = None) -> Markers:
    """Read a C3D file's points. Parameters and errors as `markers.read`; says so where ezc3d is not installed."""
    _check_sizes(path)
    content = _parsed(path)
    points = content["parameters"]["POINT"]
    given = _labels(points)
    data = np.asarray(content["data"]["points"], dtype=np.float64)  # (4, n, frames)
    positions = np.ascontiguousarray(data[:3].transpose(2, 1, 0))
    count = positions.shape[1]
    if not given or not count or not len(positions):
        raise FormatError(f"{path.name} holds {count} points but names {len(given)}.", EXPECTED)
    notices = []
    if len(given) < count:
        notices.append(f"The file names {len(given)} of its {count} points: the others go by their place.")
    labels, doubled = each_once([*given[:count], *[""] * (count - len(given))])
    residuals = np.asarray(content["data"]["meta_points"]["residuals"]).reshape(-1, data.shape[1], data.shape[2])[0].T
    gap = ~np.isfinite(positions).all(axis=2) | (residuals < 0) | (positions == 0).all(axis=2)
    positions[gap] = np.nan
    said = next((str(value).strip().lower() for value in points.get("UNITS", {}).get("value", [])), "mm")
    scale = TO_MM.get(unit or said)
    if scale is None:
        raise FormatError(f"{path.name} is in the unit {said[:20]!r}.", "Retake reads mm, cm and m.")
    return Markers(positions * scale, labels, fps or float(points["RATE"]["value"][0]), path.name, (*notices, *doubled))


def _labels(points: Any) -> list[str]:
    """Return the names of all points: a list holds at most 255, the next follow in LABELS2, LABELS3 and so on."""
    names: list[str] = []
    for number in range(1, MOST_LISTS):
        listed = points.get("LABELS" if number == 1 else f"LABELS{number}")
        if listed is None:
            break
        names += [str(label).strip() for label in listed["value"]]
    return names


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
    _require_byte_order(path, header[0], size)
    points, _, first, last = struct.unpack_from("<HHHH", header, 2)
    frames = max(0, last - first + 1)
    if points * frames * SMALLEST_POINT > size:
        raise FormatError(f"{path.name} declares more points than it holds.", "The file may be cut off or damaged.")
    CAPTURE_BUDGET.require(path.name, frames=frames, values=4 * points * frames)


def _require_byte_order(path: Path, block: int, size: int) -> None:
    """Refuse the byte order of SGI machines by name; the parameters, at a block of 512 bytes, say who wrote them."""
    place = (block - 1) * HEADER_BYTES + 3
    if not 0 <= place < size:
        raise FormatError(f"{path.name} is cut off: its parameters are beyond its end.", EXPECTED)
    with path.open("rb") as file:
        file.seek(place)
        processor = file.read(1)[0]
    if processor == SGI:
        raise FormatError(
            f"{path.name} was written in the byte order of SGI (MIPS) machines, which Retake does not read.",
            "Export it again with Intel byte order, or as TRC or CSV.",
        )


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
