"""Words and phones with their times, written: a TextGrid for Praat, or CSV with a row for each word and phone."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from pathlib import Path

from engine.errors import FormatError
from engine.formats.base.atomic import write_bytes
from engine.speech.transcript import Transcript
from engine.speech.visemes import Cue

COLUMNS = ("tier", "start_s", "stop_s", "label", "confidence")
DIGITS = 4  # of a second: tenths of a millisecond
EXPECTED = "Use .TextGrid or .csv."
_LEAST_S = 10.0**-DIGITS


def write(transcript: Transcript, path: Path) -> None:
    """Write a transcript by the ending of its file; an existing file is replaced whole or left as it was."""
    writer = WRITERS.get(path.suffix.lower())
    if writer is None:
        raise FormatError(f"{path.name} is not a kind of file that speech can be written to.", EXPECTED)
    write_bytes(path, [writer(transcript).encode()])


def _text_grid(transcript: Transcript) -> str:
    from praatio.data_classes.interval_tier import IntervalTier
    from praatio.data_classes.textgrid import Textgrid
    from praatio.utilities import textgrid_io

    end_s = round(transcript.duration_s, DIGITS)
    grid = Textgrid(0, end_s)
    for name, cues in (("words", transcript.words), ("phones", transcript.phones)):
        grid.addTier(IntervalTier(name, _entries(cues, end_s), 0, end_s))
    tiers = {
        "xmin": 0,
        "xmax": end_s,
        "tiers": [
            {"class": "IntervalTier", "name": tier.name, "xmin": 0, "xmax": end_s, "entries": tier.entries}
            for tier in grid.tiers
        ],
    }
    return str(textgrid_io.getTextgridAsStr(tiers, "long_textgrid", includeBlankSpaces=True))


def _entries(cues: Sequence[Cue], end_s: float) -> list[tuple[float, float, str]]:
    """Return cues as Praat takes them: rounded, none empty, none beyond the end."""
    rounded = [(round(cue.start_s, DIGITS), min(round(cue.stop_s, DIGITS), end_s), _label(cue)) for cue in cues]
    return [entry for entry in rounded if entry[1] - entry[0] > _LEAST_S / 2]


def _label(cue: Cue) -> str:
    return "sil" if cue.label == "SIL" else " ".join(cue.label.split())


def _csv(transcript: Transcript) -> str:
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for each in transcript.said:
        table.writerow(["word", *_times(each.start_s, each.stop_s), each.word, f"{each.confidence:.3f}"])
    for cue in transcript.phones:
        table.writerow(["phone", *_times(cue.start_s, cue.stop_s), _label(cue), ""])
    return text.getvalue()


def _times(start_s: float, stop_s: float) -> tuple[str, str]:
    return f"{start_s:.{DIGITS}f}", f"{stop_s:.{DIGITS}f}"


WRITERS: dict[str, Callable[[Transcript], str]] = {".textgrid": _text_grid, ".csv": _csv}
