"""Mouth cues as Rhubarb Lip Sync writes them: TSV, XML or JSON; shapes A to F, G, H and X."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from engine.errors import FormatError
from engine.formats.base.textfile import read_text
from engine.speech.visemes import Cue

# The class that each mouth shape looks most like.
SHAPES = {"A": "mbp", "B": "sz", "C": "eh", "D": "aa", "E": "ao", "F": "uw", "G": "fv", "H": "tn", "X": "sil"}
MAX_BYTES = 16 << 20
_EXPECTED = "Retake reads the TSV, XML and JSON that Rhubarb Lip Sync writes."


def read(path: Path, say: Callable[[str], None] = lambda _: None) -> tuple[None, list[Cue]]:
    """Return the cues, of no tier, with their shapes as viseme classes; a shape that is none stays as it is written.

    `say` hears of cues without times that can be, which are left out. Raises `FormatError` for what holds no cues.
    """
    text = read_text(path, at_most=MAX_BYTES)
    rows = {".json": _json, ".xml": _xml}.get(path.suffix.lower(), _tsv)(text, path)
    if not rows:
        raise FormatError(f"{path.name} holds no mouth cues.", _EXPECTED)
    cues = [_cue(row) for row in rows]
    if missing := cues.count(None):
        if missing == len(cues):
            raise FormatError(f"{path.name} has no start, end and shape in any of its cues.", _EXPECTED)
        first = cues.index(None) + 1
        say(f"{path.name} has no possible start and end in {missing} of {len(cues)} cues, the first in cue {first}.")
    return None, [cue for cue in cues if cue is not None]


def _cue(row: Sequence[Any]) -> Cue | None:
    try:
        start, stop, shape = float(row[0]), float(row[1]), str(row[2]).strip()
    except (TypeError, ValueError, OverflowError):
        return None
    return Cue(start, stop, SHAPES.get(shape, shape)) if 0 <= start <= stop < 1e9 else None


def _tsv(text: str, path: Path) -> list[Sequence[Any]]:
    rows = [line.split("\t") for line in text.splitlines() if line.strip()]
    if any(len(row) != 2 for row in rows):
        raise FormatError(f"{path.name} is not a list of times and mouth shapes.", _EXPECTED)
    stops = [row[0] for row in rows[1:]] + [row[0] for row in rows[-1:]]
    return [(row[0], stop, row[1]) for row, stop in zip(rows, stops, strict=True)]


def _json(text: str, path: Path) -> list[Sequence[Any]]:
    try:
        cues = json.loads(text)["mouthCues"]
        return [tuple(cue.get(key) for key in ("start", "end", "value")) for cue in cues]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise FormatError(f"{path.name} holds no mouth cues.", _EXPECTED) from None


def _xml(text: str, path: Path) -> list[Sequence[Any]]:
    if "<!DOCTYPE" in text or "<!ENTITY" in text:  # no cue file needs one, and entities can grow without bound
        raise FormatError(f"{path.name} declares a document type, which mouth cues do not need.", _EXPECTED)
    try:
        found = list(ElementTree.fromstring(text).iter("mouthCue"))
    except (ElementTree.ParseError, ValueError, RecursionError):
        raise FormatError(f"{path.name} is not well-formed XML.", _EXPECTED) from None
    return [(cue.get("start"), cue.get("end"), cue.text or "") for cue in found]
