"""The 18 viseme classes that steer a fill (BSS20 table 1), and the labels that stand for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.errors import EditError
from engine.speech.alphabets import ARPABET, CLASSES, IPA, class_anywhere
from engine.take import Array

__all__ = ["CLASSES", "INDEX", "NAMES", "Cue", "begun_at", "class_of", "classes_over", "one_hot", "require_time"]

NAMES: tuple[str, ...] = tuple(CLASSES)
INDEX: dict[str, int] = {
    **{label.lower(): NAMES.index(name) for label, name in (*IPA.items(), *ARPABET.items())},
    **{name: index for index, name in enumerate(NAMES)},
}
FARTHEST_S = 3e7


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


def classes_over(cues: Sequence[Cue], *, frames: int, fps: float) -> np.ndarray:
    """Return the class at each frame, (frames,) int, −1 where no cue lies; the later of two overlapping cues counts.

    Raises `EditError` for an unknown label or a cue that ends before it begins.
    """
    classes = np.full(frames, -1)
    for cue in cues:
        if not (np.isfinite([cue.start_s, cue.stop_s]).all() and cue.start_s <= cue.stop_s):
            raise EditError(f"The cue {cue.label!r} ends before it begins.")
        first, last = np.clip(np.ceil(np.array([cue.start_s, cue.stop_s]) * fps - 0.5), 0, frames).astype(int)
        classes[first:last] = class_of(cue.label)
    return classes


def one_hot(classes: np.ndarray) -> Array:
    """Return (frames, 18) with a one at each frame's class, and all zero where the class is −1."""
    hot = np.zeros((len(classes), len(NAMES)))
    present = classes >= 0
    hot[np.flatnonzero(present), classes[present]] = 1.0
    return hot
