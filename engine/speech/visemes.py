"""The 18 viseme classes that steer a fill (BSS20 table 1), and the labels that stand for them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from engine.errors import EditError
from engine.speech.alphabets import CLASSES, IPA, class_anywhere, ipa_base
from engine.take import Array

__all__ = [
    "CLASSES",
    "NAMES",
    "Cue",
    "begun_at",
    "class_of",
    "classes_over",
    "one_hot",
    "require_time",
    "shapes",
]

NAMES: tuple[str, ...] = tuple(CLASSES)
CONTACTS = frozenset({"mbp", "fv"})  # lips or teeth meet: seen however briefly
FARTHEST_S = 3e7
_GLIDES = {
    **dict.fromkeys(("AY", "EY", "OY", "aɪ", "ai", "aj", "ɑɪ", "eɪ", "ei", "ej", "ɛɪ", "ɔɪ", "ɔj", "ɔʏ"), "iy"),
    **dict.fromkeys(("AW", "aʊ", "au", "aw"), "uw"),
}  # diphthongs, and the class that they end as
_ASPIRATES = frozenset({"HH", "H", "HV", "h", "ɦ"})
_FOLLOWED = frozenset({"ao", "aa", "eh", "iy", "ow", "ah", "uw", "w", "r"})  # vowels and glides


@dataclass(frozen=True)
class Tuning:
    """Constants of how phones run into each other.

    Attributes
    ----------
    glide_at : share of a diphthong after which it has the shape of its end; not fitted. Its first vowel takes the
        larger part in read English (Gay 1968)
    apart_s : seconds of silence beyond which an H no longer takes the shape of the vowel after it; not fitted
    """

    glide_at: float = 0.6
    apart_s: float = 0.03


TUNING = Tuning()


@dataclass(frozen=True)
class Cue:
    """A label over a stretch of time: a phone, or the name of a viseme class."""

    start_s: float
    stop_s: float
    label: str


def class_of(label: str) -> int:
    """Return the class, 0..17, of a viseme name, an ARPAbet phone with or without stress, or an IPA symbol.

    Raises `EditError` for a label that is none of these.
    """
    name = class_anywhere(label)
    if name is None:
        raise EditError(
            f"There is no viseme or phone called {label.strip()[:40]!r}.",
            f"Use ARPAbet phones, such as M or AA1, or one of: {', '.join(NAMES)}.",
        )
    return NAMES.index(name)


def require_time(offset_s: float) -> None:
    """Raise `EditError` where visemes cannot begin at so many seconds of a take."""
    if not abs(offset_s) < FARTHEST_S:
        raise EditError("The visemes can only be shifted by a finite number of seconds, less than a year.")


def begun_at(cues: Sequence[Cue], offset_s: float) -> tuple[Cue, ...]:
    """Return the cues of a file that begins at a time of the take; raises `EditError` for one that is no time."""
    require_time(offset_s)
    return tuple(Cue(cue.start_s + offset_s, cue.stop_s + offset_s, cue.label) for cue in cues)


def shapes(cues: Sequence[Cue]) -> tuple[Cue, ...]:
    """Return cues whose labels are classes: diphthongs in two parts, and each H in the shape of the vowel after it.

    Raises `EditError` for an unknown label.
    """
    known = {label: (NAMES[class_of(label)], *_symbols(label)) for label in {cue.label for cue in cues}}
    return tuple(_shapes(cues, known))


def _shapes(cues: Sequence[Cue], known: dict[str, tuple[str, str, str | None]]) -> Iterator[Cue]:
    for cue, after in zip(cues, (*cues[1:], None)[: len(cues)], strict=True):
        name, symbol, end = known[cue.label]
        if symbol in _ASPIRATES and after is not None and after.start_s - cue.stop_s < TUNING.apart_s:
            follows = known[after.label][0]
            name = follows if follows in _FOLLOWED else name
        if end is None:
            yield replace(cue, label=name)
        else:
            turn_s = cue.start_s + TUNING.glide_at * (cue.stop_s - cue.start_s)
            yield Cue(cue.start_s, turn_s, name)
            yield Cue(turn_s, cue.stop_s, end)


def _symbols(label: str) -> tuple[str, str | None]:
    """Return a label without stress, length and place in its word, and the class that it ends as where it glides."""
    text = label.strip()
    symbol = text if text in IPA else ipa_base(text).lstrip("\"'’,%").rstrip("_BIES").strip("012")
    upper = symbol.upper()
    return (
        (symbol, _GLIDES[symbol]) if symbol in _GLIDES else (upper if symbol not in IPA else symbol, _GLIDES.get(upper))
    )


def classes_over(cues: Sequence[Cue], *, frames: int, fps: float) -> np.ndarray:
    """Return the class at each frame, (frames,) int, −1 where no cue lies; the later of two overlapping cues counts.

    A contact that covers the middle of no frame has the frame that it is in. Raises `EditError` for an unknown label or
    a cue that ends before it begins.
    """
    classes = np.full(frames, -1)
    for cue in cues:
        if not (np.isfinite([cue.start_s, cue.stop_s]).all() and cue.start_s <= cue.stop_s):
            raise EditError(f"The cue {cue.label!r} ends before it begins.")
    brief: list[tuple[int, int]] = []
    for cue in shapes(cues):
        at, number = np.array([cue.start_s, cue.stop_s]) * fps, NAMES.index(cue.label)
        first, last = np.clip(np.ceil(at - 0.5), 0, frames).astype(int)
        classes[first:last] = number
        if first == last and cue.label in CONTACTS and cue.stop_s > cue.start_s:
            brief.append((int(np.floor(np.clip(at.mean(), -1.0, frames))), number))
    for frame, number in brief:
        if 0 <= frame < frames:
            classes[frame] = number
    return classes


def one_hot(classes: np.ndarray) -> Array:
    """Return (frames, 18) with a one at each frame's class, and all zero where the class is −1."""
    hot = np.zeros((len(classes), len(NAMES)))
    present = classes >= 0
    hot[np.flatnonzero(present), classes[present]] = 1.0
    return hot
