"""Praat TextGrid: the phones of an aligned recording; long and short form, UTF-8 or UTF-16."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from engine.errors import FormatError
from engine.formats.textfile import read_text
from engine.speech.visemes import Cue

PHONE_TIERS = ("phones", "phone", "phonemes", "phoneme", "visemes", "viseme", "segments", "mau")
# A quoted text (doubled quotes inside), an index in brackets to skip, a flag, or a number standing for itself. Both
# forms of the format are the same sequence of texts and numbers; the long one only names them.
_TOKEN = re.compile(
    r'"(?P<text>(?:[^"]|"")*)"|\[[^\]\n]*\]|(?P<flag><\w+>)|(?<![\w.])(?P<number>-?\d[\d.eE+-]*)(?![\w.])'
)


def read(path: Path) -> list[Cue]:
    """Return the intervals of the tier that holds phones or visemes; the first where several have its name.

    Raises `FormatError` for what is not a TextGrid, or has no such tier.
    """
    tokens = _tokens(read_text(path))
    try:
        if (next(tokens), next(tokens)) != ("ooTextFile", "TextGrid"):
            raise FormatError(f"{path.name} is not a TextGrid.", "Retake reads the text forms that Praat writes.")
        tiers = list(_tiers(tokens, path))
    except (StopIteration, RuntimeError):
        raise FormatError(f"{path.name} ends in the middle of a tier.", "The file may be cut off.") from None
    for wanted in PHONE_TIERS:
        for name, cues in tiers:
            if name.strip().lower().split(" - ")[-1] == wanted:
                return cues
    if len(tiers) == 1:
        return tiers[0][1]
    found = ", ".join(repr(name[:40]) for name, _ in tiers[:8]) or "no tiers"
    raise FormatError(f"{path.name} has no tier of phones: it has {found}.", "Name the tier 'phones'.")


def _tokens(text: str) -> Iterator[str | float]:
    for match in _TOKEN.finditer(text):
        if match["text"] is not None:
            yield match["text"].replace('""', '"')
        elif match["flag"] is not None:
            yield match["flag"]
        elif match["number"] is not None:
            try:
                yield float(match["number"])
            except ValueError:
                yield match["number"]


def _tiers(tokens: Iterator[str | float], path: Path) -> Iterator[tuple[str, list[Cue]]]:
    _number(tokens, path), _number(tokens, path)  # the span of the whole grid
    if next(tokens) != "<exists>":
        return
    for _ in range(int(_number(tokens, path))):
        kind, name = next(tokens), str(next(tokens))
        if kind not in ("IntervalTier", "TextTier"):
            raise FormatError(f"{path.name} has a tier of the unknown kind {str(kind)[:40]!r}.")
        _number(tokens, path), _number(tokens, path)
        cues = []
        for _ in range(int(_number(tokens, path))):
            start = _number(tokens, path)
            stop = _number(tokens, path) if kind == "IntervalTier" else start
            cues.append(Cue(start, stop, str(next(tokens))))
        yield name, cues


def _number(tokens: Iterator[str | float], path: Path) -> float:
    token = next(tokens)
    if not isinstance(token, float) or not abs(token) < 1e9:
        raise FormatError(f"{path.name} has {str(token)[:40]!r} where a number belongs.")
    return token
