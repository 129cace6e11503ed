"""Mouth cues as Rhubarb Lip Sync writes them: TSV, XML or JSON; shapes A to F, G, H and X."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from engine.errors import FormatError
from engine.formats.textfile import read_text
from engine.speech.visemes import Cue

# The class that each mouth shape looks most like.
SHAPES = {"A": "mbp", "B": "sz", "C": "eh", "D": "aa", "E": "ao", "F": "uw", "G": "fv", "H": "tn", "X": "sil"}
_EXPECTED = "Retake reads the TSV, XML and JSON that Rhubarb Lip Sync writes."


def read(path: Path) -> list[Cue]:
    """Return the cues with their shapes as viseme classes; raises `FormatError` that names the cue to blame."""
    text = read_text(path)
    rows = {".json": _json, ".xml": _xml}.get(path.suffix.lower(), _tsv)(text, path)
    return [_cue(row, number, path) for number, row in enumerate(rows, start=1)]


def _cue(row: Sequence[Any], number: int, path: Path) -> Cue:
    try:
        start, stop, shape = float(row[0]), float(row[1]), str(row[2]).strip()
    except (TypeError, ValueError, IndexError):
        raise FormatError(f"{path.name} has no start, end and shape in cue {number}.", _EXPECTED) from None
    if not 0 <= start <= stop < 1e9:
        raise FormatError(f"{path.name} has a cue that ends before it begins: number {number}.")
    if shape not in SHAPES:
        raise FormatError(
            f"{path.name} has the unknown mouth shape {shape[:40]!r} in cue {number}.",
            f"Shapes are: {', '.join(SHAPES)}.",
        )
    return Cue(start, stop, SHAPES[shape])


def _tsv(text: str, path: Path) -> list[Sequence[Any]]:
    rows = [line.split("\t") for line in text.splitlines() if line.strip()]
    if any(len(row) != 2 for row in rows):
        raise FormatError(f"{path.name} is not a list of times and mouth shapes.", _EXPECTED)
    stops = [row[0] for row in rows[1:]] + [row[0] for row in rows[-1:]]
    return [(row[0], stop, row[1]) for row, stop in zip(rows, stops, strict=True)]


def _json(text: str, path: Path) -> list[Sequence[Any]]:
    try:
        cues = json.loads(text)["mouthCues"]
        return [(cue["start"], cue["end"], cue["value"]) for cue in cues]
    except (ValueError, KeyError, TypeError, RecursionError):
        raise FormatError(f"{path.name} holds no mouth cues.", _EXPECTED) from None


def _xml(text: str, path: Path) -> list[Sequence[Any]]:
    if "<!DOCTYPE" in text or "<!ENTITY" in text:  # no cue file needs one, and entities can grow without bound
        raise FormatError(f"{path.name} declares a document type, which mouth cues do not need.", _EXPECTED)
    try:
        found = list(ElementTree.fromstring(text).iter("mouthCue"))
    except ElementTree.ParseError:
        raise FormatError(f"{path.name} is not well-formed XML.", _EXPECTED) from None
    return [(cue.get("start"), cue.get("end"), cue.text or "") for cue in found]
