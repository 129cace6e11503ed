"""Markers as C3D; a marker with a negative residual or at exactly 0, 0, 0 is a gap."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from engine.errors import FormatError
from engine.formats.base.content import content_of
from engine.formats.markers.c3d_file import BLOCK, C3D, SGI, C3DError, Parameter, Parameters, parse
from engine.formats.markers.capture import CAPTURE_BUDGET, FARTHEST_MM, TO_MM, Markers, each_once
from engine.words import counted

EXPECTED = "Retake reads C3D files with labelled points."
MOST_LISTS = 64  # of labels: 16,000 points


def read(path: Path, *, unit: str | None = None, fps: float | None = None) -> Markers:
    """Read a C3D file's points. Parameters and errors as `markers.read`."""
    content = _parsed(path)
    given, positions = _labels(content.parameters), content.positions
    count = positions.shape[1]
    if not given:
        raise FormatError(f"{path.name} holds {counted(count, 'point')} but names none.", EXPECTED)
    notices = []
    if len(given) < count:
        notices.append(f"The file names {len(given)} of its {counted(count, 'point')}: the others go by their place.")
    labels, doubled = each_once([*given[:count], *[""] * (count - len(given))])
    texts = content.parameters.get(("POINT", "UNITS"), Parameter()).texts
    stated = texts[0].lower() if texts and texts[0] else "mm"
    scale = TO_MM.get(unit or stated)
    if scale is None:
        raise FormatError(f"{path.name} is in the unit {stated[:20]!r}.", "Retake reads mm, cm and m.")
    seen = np.isfinite(positions).all(axis=2) & ~(content.residuals < 0) & ~(positions == 0).all(axis=2)
    placed = np.where(seen[..., None], positions, np.nan)
    if (np.abs(placed) > FARTHEST_MM).any():
        raise FormatError(f"{path.name} has a point further away than a face can be.", "It may be damaged.")
    rates = content.parameters.get(("POINT", "RATE"), Parameter()).numbers
    rate = fps or (rates[0] if rates else content.rate)
    return Markers(placed * scale, labels, rate, path.name, (*notices, *doubled))


def _labels(parameters: Parameters) -> list[str]:
    """Return the names of all points: a list holds at most 255, the next follow in LABELS2, LABELS3 and so on."""
    names: list[str] = []
    for number in range(1, MOST_LISTS):
        listed = parameters.get(("POINT", "LABELS" if number == 1 else f"LABELS{number}"))
        if listed is None:
            break
        names += listed.texts
    return names


def _parsed(path: Path) -> C3D:
    content = content_of(path)
    place = (content[0] - 1) * BLOCK + 3 if content else -1
    if len(content) >= BLOCK and content[1] == 0x50 and 0 <= place < len(content) and content[place] == SGI:
        raise FormatError(
            f"{path.name} was written in the byte order of SGI (MIPS) machines, which Retake does not read.",
            "Export it again with Intel byte order, or as TRC or CSV.",
        )
    try:
        return parse(content, path.name, CAPTURE_BUDGET)
    except C3DError as error:
        raise FormatError(f"{path.name} {error}.", EXPECTED) from error
