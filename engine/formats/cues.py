"""Files that say what is said when: one reader for all kinds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from engine.errors import FormatError
from engine.formats import mouthcues, textgrid
from engine.speech.alphabets import CLASSES, MAX_LABELS, alphabet_of, known_as
from engine.speech.visemes import Cue

Say = Callable[[str], None]
READERS: dict[str, Callable[[Path, Say], tuple[str | None, list[Cue]]]] = {
    ".textgrid": textgrid.read,
    ".tsv": mouthcues.read,
    ".xml": mouthcues.read,
    ".json": mouthcues.read,
}
MAX_CUES = 500_000  # ten hours of speech
NAMED = 4  # unknown labels that a sentence names


def read_cues(path: Path, say: Say = lambda _: None) -> list[Cue]:
    """Read phones or visemes with their times from a TextGrid or a mouth-cue file.

    A label that is no phone leaves its stretch out, and `say` hears of all of them in one sentence. Raises
    `FormatError` only for a file that is of none of these kinds.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise FormatError(
            f"{path.name} is not a kind of file that visemes can be in.",
            "Use a TextGrid, or Rhubarb's TSV, XML or JSON.",
        )
    tier, cues = reader(path, say)
    if len(cues) > MAX_CUES:
        raise FormatError(
            f"{path.name} holds more than {MAX_CUES:,} cues.", "Cut out the part that belongs to the take."
        )
    return _understood(cues, tier, path, say)


def _understood(cues: Sequence[Cue], tier: str | None, path: Path, say: Say) -> list[Cue]:
    """Return the cues whose labels are phones of a tier, or classes where there is none, as `class_of` knows them."""
    labels = list(dict.fromkeys(cue.label for cue in cues))
    if tier is None:
        known = {label: label if label in CLASSES else None for label in labels}
    else:
        alphabet = alphabet_of((cue.label for cue in cues), tier)
        known = {label: known_as(label, alphabet) if at < MAX_LABELS else None for at, label in enumerate(labels)}
    unknown = [label for label in labels if known[label] is None]
    if unknown:
        count = sum(known[cue.label] is None for cue in cues)
        shown = ", ".join(repr(label[:16]) for label in unknown[:NAMED]) + ("…" if len(unknown) > NAMED else "")
        kind = "phone" if tier is not None else "mouth shape"
        stretches = "1 stretch stays" if count == 1 else f"{count:,} of {len(cues):,} stretches stay"
        say(f"{path.name} has labels that Retake knows as no {kind} ({shown}): {stretches} unguided.")
    found = [(cue, known[cue.label]) for cue in cues]
    return [cue if label == cue.label else replace(cue, label=label) for cue, label in found if label is not None]
