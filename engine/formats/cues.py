"""Files that say what is said when: one reader for all kinds."""

from __future__ import annotations

from pathlib import Path

from engine.errors import FormatError
from engine.formats import mouthcues, textgrid
from engine.speech.visemes import Cue

READERS = {".textgrid": textgrid.read, ".tsv": mouthcues.read, ".xml": mouthcues.read, ".json": mouthcues.read}


def read_cues(path: Path) -> list[Cue]:
    """Read phones or visemes with their times from a TextGrid or a mouth-cue file; raises `FormatError`."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise FormatError(
            f"{path.name} is not a kind of file that visemes can be in.",
            "Use a TextGrid, or Rhubarb's TSV, XML or JSON.",
        )
    return reader(path)
