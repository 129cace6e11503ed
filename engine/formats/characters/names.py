"""Which of a file's shapes is which ARKit shape: a table that a person can review and correct."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from engine.errors import EditError
from engine.take import SHAPES

SURE = 0.8  # likeness from which a guess is taken without asking
WORTH_SHOWING = 0.6
# Splits of one ARKit shape into two halves, and other programs' names for a shape.
HALVES = ("browInnerUp", "cheekPuff", "mouthFunnel", "mouthPucker")
OTHER_NAMES = {"jawopen": ("mouthopen", "jawdrop"), "eyeblinkleft": ("eyecloseleft", "blinkleft")} | {
    "eyeblinkright": ("eyecloseright", "blinkright"),
    "tongueout": ("tonguestickout",),
}
_SIDE = {"l": "left", "r": "right", "lf": "left", "rt": "right"}
_LEADING = ("blendshapes", "blendshape", "bs", "arkit", "shape", "morph", "target", "head", "face", "expression")


@dataclass(frozen=True)
class Match:
    """One row of the review table.

    Attributes
    ----------
    source : the file's name of the shape
    shape : the ARKit shape it is taken for; empty where it is left out
    likeness : 0..1; 1 is the same name in another spelling
    """

    source: str
    shape: str
    likeness: float

    @property
    def sure(self) -> bool:
        """Whether the guess is taken without asking."""
        return bool(self.shape) and self.likeness >= SURE


def plain(name: str) -> str:
    """Return a name without case, separators, prefixes and numbering, sides in full and at the end."""
    last = re.split(r"[.:|/]", name)[-1] if not re.search(r"[.:|/]\d*$", name) else name
    words = re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+", last)
    lower = [word.lower() for word in words if not word.isdigit()]
    while len(lower) > 1 and lower[0] in _LEADING:
        lower = lower[1:]
    sides = [_SIDE.get(word, word) for word in lower if _SIDE.get(word, word) in ("left", "right")]
    rest = [word for word in lower if _SIDE.get(word, word) not in ("left", "right")]
    return "".join(rest + sides)


_PLAIN = {plain(shape): shape for shape in SHAPES}
_KNOWN = _PLAIN | {other: _PLAIN[name] for name, others in OTHER_NAMES.items() for other in others}
_KNOWN |= {plain(f"{shape}{side}"): shape for shape in HALVES for side in ("Left", "Right")}


def match_names(names: Iterable[str]) -> list[Match]:
    """Return a row for each of the file's shapes: the ARKit shape most like it, or none.

    Where two names want one shape, the likelier has it, except that the two halves of a shape share it.
    """
    guesses = [_guess(name) for name in names]
    taken: dict[str, Match] = {}
    for guess in sorted(guesses, key=lambda match: -match.likeness):
        if guess.shape and (guess.shape not in taken or _halves(guess, taken[guess.shape])):
            taken.setdefault(guess.shape, guess)
        elif guess.shape:
            guesses[guesses.index(guess)] = replace(guess, shape="", likeness=0.0)
    return guesses


def _guess(name: str) -> Match:
    key = plain(name)
    if key in _KNOWN:
        return Match(name, _KNOWN[key], 1.0)
    side = key.removesuffix("left").removesuffix("right") != key
    # A shape's side is certain where it is written: likeness of the rest must not turn left into right.
    ending = "left" if key.endswith("left") else "right"
    pool = [known for known in _KNOWN if (known.endswith(ending) if side else not known.endswith(("left", "right")))]
    likeness, best = max(
        ((difflib.SequenceMatcher(None, key, known).ratio(), known) for known in pool), default=(0.0, "")
    )
    return Match(name, _KNOWN[best], round(likeness, 3)) if likeness >= WORTH_SHOWING else Match(name, "", 0.0)


def _halves(one: Match, other: Match) -> bool:
    keys = sorted((plain(one.source), plain(other.source)))
    return one.likeness == other.likeness == 1.0 and keys == [f"{plain(one.shape)}left", f"{plain(one.shape)}right"]


def corrected(matches: Iterable[Match], changes: Mapping[str, str]) -> list[Match]:
    """Return the table after a review: `changes` gives the ARKit shape, or nothing, for names of the file.

    Raises `EditError` for a name the file has not or a shape that is not ARKit's.
    """
    rows = list(matches)
    known = {row.source for row in rows}
    for source, shape in changes.items():
        if source not in known:
            raise EditError(f"The file has no shape called {source!r}.")
        if shape and shape not in SHAPES:
            raise EditError(f"There is no shape called {shape!r}.", "Shapes have ARKit names, such as jawOpen.")
    return [Match(row.source, changes[row.source], 1.0) if row.source in changes else row for row in rows]
