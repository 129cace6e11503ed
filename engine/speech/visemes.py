"""The 18 viseme classes that steer a fill (BSS20 table 1), and the labels that stand for them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.errors import EditError
from engine.take import Array

# Class -> ARPAbet phones. The paper's Y stands with S and Z; here it stands with the vowel that it is a glide of.
CLASSES: dict[str, tuple[str, ...]] = {
    "sil": ("SIL", "SP", "SPN", "PAU"),
    "ao": ("AO", "OY"),
    "aa": ("AA", "AE", "AY"),
    "eh": ("EH", "EY"),
    "iy": ("IH", "IY", "EE", "IX", "Y"),
    "ow": ("OH", "OW"),
    "ah": ("AH", "ER", "AX", "AXR"),
    "uw": ("UW", "AW", "UH"),
    "jh": ("JH",),
    "kg": ("G", "K", "HH", "H", "NG"),
    "tn": ("L", "N", "T", "D", "DX", "EL", "EN"),
    "sz": ("S", "Z"),
    "sh": ("SH", "CH", "ZH"),
    "th": ("TH", "DH"),
    "fv": ("F", "V"),
    "mbp": ("M", "B", "P", "EM"),
    "w": ("W", "WH"),
    "r": ("R",),
}
NAMES: tuple[str, ...] = tuple(CLASSES)
# Aligners that write IPA, as far as its symbols are not ARPAbet letters already.
FARTHEST_S = 3e7
_IPA = {
    "sil": " spn ∅",
    "ao": "ɔ ɔj ɔɪ ɒ",
    "aa": "a ɑ æ aj aɪ ɐ",
    "eh": "ɛ e ej eɪ",
    "iy": "i ɪ j ɨ",
    "ow": "o ow oʊ əʊ əw",
    "ah": "ə ʌ ɜ ɝ ɚ",
    "uw": "u ʊ ʉ aw aʊ",
    "jh": "dʒ ɟ",
    "kg": "ɡ g c ŋ ɲ ç x q",
    "tn": "ɾ t̪ d̪ ɫ ʎ l n t d",
    "sh": "ʃ tʃ ʒ",
    "th": "θ ð",
    "r": "ɹ ʁ",
}
_STRESS = re.compile(r"(?<=[^\W\d])[012ːˑ]+$")  # ARPAbet writes stress behind a vowel, IPA length
INDEX: dict[str, int] = {
    **{name: index for index, name in enumerate(NAMES)},
    **{label: NAMES.index(name) for name, labels in _IPA.items() for label in labels.split()},
    **{phone.lower(): NAMES.index(name) for name, phones in CLASSES.items() for phone in phones},
    "": 0,
}


@dataclass(frozen=True)
class Cue:
    """What is said over a stretch of time: a phone, or the name of a viseme class."""

    start_s: float
    stop_s: float
    label: str


def class_of(label: str) -> int:
    """Return the class, 0..17, of a viseme name, an ARPAbet phone with or without stress, or an IPA symbol.

    Raises `EditError` for a label that is none of these.
    """
    plain = _STRESS.sub("", label.strip().lower())
    if plain not in INDEX:
        raise EditError(
            f"There is no viseme or phone called {label.strip()[:40]!r}.",
            f"Use ARPAbet phones, such as M or AA1, or one of: {', '.join(NAMES)}.",
        )
    return INDEX[plain]


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
    said = classes >= 0
    hot[np.flatnonzero(said), classes[said]] = 1.0
    return hot
