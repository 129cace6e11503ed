"""Praat TextGrid: the phones of an aligned recording, in every form that Praat itself reads.

Praat reads a text file as a row of texts, numbers and flags that stand free, and skips all else: names of fields,
counts in brackets, comments. Files are brought to the plainest such form, one to a line, which praatio then reads.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from engine.errors import FormatError
from engine.formats.base.textfile import read_text
from engine.speech.alphabets import MAX_LABELS, class_anywhere
from engine.speech.visemes import Cue

MAX_BYTES = 32 << 20  # eight hours of phones in the long form
MAX_TOKENS = 4_000_000
EXPECTED = "Retake reads the text forms that Praat writes."
PHONE_TIERS = ("phones", "phone", "phonemes", "phoneme", "visemes", "viseme", "segments", "mau", "phonalign")
WORD_TIERS = ("word", "ort", "kan", "token", "utter", "trans", "syll", "text")
# A text with doubled quotes inside it, which may not be closed; what stands in brackets; a comment; anything else.
_TOKEN = re.compile(
    r'"(?P<text>(?:[^"]|"")*+)(?:"|\Z)|(?<!\S)!(?P<comment>[^\n\r]*)|\[[^\]\n"]{0,40}\]?|(?P<word>[^\s"\[]+)'
)
_NUMBER = re.compile(r"[+-]?\d{1,40}(?:[.,]\d{0,40})?(?:[eE][+-]?\d{1,4})?")
_QUOTE = "\ue000"  # stands for a quote within a text while praatio reads it


@dataclass(frozen=True)
class Tier:
    """A tier of intervals: its name, and begin, end and label of each, in seconds."""

    name: str
    cues: tuple[Cue, ...]


def read(path: Path, say: Callable[[str], None] = lambda _: None) -> tuple[str, list[Cue]]:
    """Return the name and the intervals of the tier that holds phones or visemes.

    `say` hears about what could not be read. Raises `FormatError` for what is no TextGrid, or has no intervals.
    """
    tokens = list(islice(_tokens(read_text(path, at_most=MAX_BYTES, latin=True)), MAX_TOKENS + 1))
    if len(tokens) > MAX_TOKENS:
        raise FormatError(f"{path.name} holds more than Retake reads of a TextGrid.", "Cut out the take's part.")
    kinds = [token for token in tokens[:2] if token.startswith('"')]
    if not kinds or kinds[0].split()[0].strip('"') != "ooTextFile" or "TextGrid" not in kinds[-1]:
        raise FormatError(f"{path.name} is not a TextGrid.", EXPECTED)
    tiers = [tier for tier in _tiers(tokens, path, say) if tier.cues]
    if not tiers:
        raise FormatError(f"{path.name} holds no intervals.", "Visemes need a tier of phones with their times.")
    found = max(tiers, key=_likelihood)
    return found.name, list(found.cues)


def _tokens(text: str) -> Iterator[str]:
    """Yield texts in quotes, flags and numbers as they stand free, in the order of the file."""
    for match in _TOKEN.finditer(text):
        if match["text"] is not None:
            label = " ".join(match["text"].replace('""', _QUOTE).split())
            yield f'"{label}"'
        elif (word := match["word"]) and (word.startswith("<") or _NUMBER.fullmatch(word)):
            yield word.replace(",", ".")


def _tiers(tokens: Iterable[str], path: Path, say: Callable[[str], None]) -> Iterator[Tier]:
    from praatio.utilities import errors, textgrid_io

    try:
        # praatio looks for the grid's own times in the fourth and fifth line
        plain = '"ooTextFile"\n"TextGrid"\n\n' + "".join(f"{token}\n" for token in islice(tokens, 2, None))
        grid = textgrid_io.parseTextgridStr(plain, includeEmptyIntervals=True)
    except (ValueError, IndexError, KeyError, errors.PraatioException):
        raise FormatError(f"{path.name} ends in the middle of a tier.", "The file may be cut off.") from None
    skipped = 0
    for tier in grid["tiers"]:
        if tier["class"] != "IntervalTier":
            continue
        cues = [_cue(*entry) for entry in tier["entries"]]
        skipped += cues.count(None)
        yield Tier(tier["name"].replace(_QUOTE, '"'), tuple(cue for cue in cues if cue is not None))
    if skipped:
        say(f"{path.name} has {skipped} intervals without times that can be: they are left out.")


def _cue(start: str, stop: str, label: str) -> Cue | None:
    try:
        start_s, stop_s = float(start), float(stop)
    except ValueError:
        return None
    if not -1e9 < start_s <= stop_s < 1e9:
        return None
    return Cue(start_s, stop_s, label.replace(_QUOTE, '"'))


def _likelihood(tier: Tier) -> tuple[int, float]:
    """Return how likely a tier holds phones: by its name, then by how much of it are phones."""
    name = tier.name.strip().lower()
    parts = re.split(r"[\s_\-.:/]+", name)
    named = next((2 * len(PHONE_TIERS) - at for at, wanted in enumerate(PHONE_TIERS) if wanted == parts[-1]), 0)
    named = named or int(any(wanted in parts or name.startswith(wanted) for wanted in PHONE_TIERS))
    if any(part.startswith(WORD_TIERS) for part in parts) and not named:
        named = -1
    labels = set(islice((cue.label for cue in tier.cues if cue.label.strip()), MAX_LABELS))
    return named, sum(class_anywhere(label) is not None for label in labels) / max(1, len(labels))
