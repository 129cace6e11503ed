"""Names of markers taken apart into words: `LMouthCorner` and `lip_corner_l` are the landmark mouth_left."""

from __future__ import annotations

import re

# Words that other captures use, and what landmarks are called by.
_ALIKE = {
    "upper": "up top",
    "lower": "low down bottom lo",
    "left": "l lt lf",
    "right": "r rt",
    "inner": "in inside",
    "outer": "out outside",
    "middle": "mid center centre",
    "brow": "eyebrow",
    "lid": "eyelid",
    "lip": "lips",
    "tip": "point",
}
_WORDS = {other: word for word, others in _ALIKE.items() for other in others.split()}
_SIDE = re.compile(r"(?<![A-Za-z])([LRlr])(?=eye|brow|cheek|mouth|lip|nostril)")  # as in Leye_Outside
_FILLERS = {"face", "marker", "mrk", "corner", "the"}


def words_of(name: str) -> frozenset[str]:
    """Return what a marker's name says, word by word, in the words of landmarks; numbers stay words of their own."""
    last = _SIDE.sub(r"\1_", re.split(r"[:|/]", name)[-1])
    found = [word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+", last)]
    words = {_WORDS.get(word, word) for word in found}
    if "lip" in words and "corner" in words:
        words = words - {"lip"} | {"mouth"}
    if "mouth" in words and words & {"upper", "lower"}:
        words = words - {"mouth"} | {"lip"}
    return frozenset(words - _FILLERS)
