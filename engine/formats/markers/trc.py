"""Markers as TRC: tab-separated, two lines of settings, the markers' names, one row per frame; gaps are empty."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan
from pathlib import Path

import numpy as np

from engine.errors import FormatError
from engine.formats.base.atomic import write_bytes
from engine.formats.markers.capture import TO_MM, Markers, each_once, unit_named
from engine.formats.markers.text import decoded, lines_of, numbers

EXPECTED = "A TRC file begins with PathFileType and names its rate, units and markers in the lines below."
HEADER_LINES = 5


def read(path: Path, *, unit: str | None = None, fps: float | None = None) -> Markers:
    """Read a TRC file; a marker at exactly 0, 0, 0 is a gap too, as some writers have it. Errors as `markers.read`."""
    lines = lines_of(path, EXPECTED)
    head = [decoded(line, path, EXPECTED) for line in lines[:HEADER_LINES]]
    if len(head) < HEADER_LINES or not head[0].startswith("PathFileType"):
        raise FormatError(f"{path.name} does not begin as a TRC file does.", EXPECTED)
    settings = dict(zip(head[1].lower().split(), head[2].split(), strict=False))
    names, doubled = each_once([cell for cell in head[3].split("\t")[2:] if cell.strip()])
    declared = _number(settings, "nummarkers", path)
    if not names or declared != len(names):
        raise FormatError(f"{path.name} says it has {declared:g} markers but names {len(names)}.", EXPECTED)
    body = [line for line in lines[HEADER_LINES:] if line.strip()]
    if not body:
        raise FormatError(f"{path.name} has a header but no frames.")
    table = numbers(body, 2 + 3 * len(names), separator=b"\t", first_row=HEADER_LINES + 1, path=path)
    positions = table[:, 2:].reshape(len(body), len(names), 3)
    gap = ~np.isfinite(positions).all(axis=2) | (positions == 0).all(axis=2)
    positions[gap] = np.nan
    found = unit or unit_named(settings.get("units", "mm"))
    if found is None:
        raise FormatError(f"{path.name} is in the unit {settings['units'][:20]!r}.", f"Use one of: {', '.join(TO_MM)}.")
    scale = TO_MM[found]
    rows = _number(settings, "numframes", path)
    notices = (
        doubled
        if rows == len(body)
        else (
            *doubled,
            f"The file says it has {rows:g} frames but holds {len(body)}.",
        )
    )
    return Markers(positions * scale, names, fps or _number(settings, "datarate", path), path.name, notices)


def _number(settings: dict[str, str], name: str, path: Path) -> float:
    try:
        value = float(settings[name])
    except (KeyError, ValueError):
        raise FormatError(f"{path.name} does not say its {name} in line 3.", EXPECTED) from None
    if not np.isfinite(value):
        raise FormatError(f"{path.name} gives {settings[name]!r} for its {name} in line 3.", EXPECTED)
    return value


def write(markers: Markers, path: Path) -> None:
    """Write a capture as TRC in mm, gaps empty."""
    write_bytes(path, _encode(markers, path.name))


def _encode(markers: Markers, file_name: str) -> Iterator[bytes]:
    frames, count = markers.positions.shape[:2]
    keys = [
        "DataRate",
        "CameraRate",
        "NumFrames",
        "NumMarkers",
        "Units",
        "OrigDataRate",
        "OrigDataStartFrame",
        "OrigNumFrames",
    ]
    values = [markers.fps, markers.fps, frames, count, "mm", markers.fps, 1, frames]
    axes = [f"{axis}{marker}" for marker in range(1, count + 1) for axis in "XYZ"]
    head = [
        f"PathFileType\t4\t(X/Y/Z)\t{file_name}",
        "\t".join(keys),
        "\t".join(str(value) for value in values),
        "Frame#\tTime\t" + "\t\t\t".join(markers.names),
        "\t\t" + "\t".join(axes),
    ]
    yield ("\n".join(head) + "\n").encode()
    for frame, row in enumerate(markers.positions.reshape(frames, -1).tolist()):
        cells = "\t".join("" if isnan(value) else f"{value:.6f}" for value in row)
        yield f"{frame + 1}\t{frame / markers.fps:.9f}\t{cells}\n".encode()
