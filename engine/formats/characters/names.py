"""Which of a file's shapes is which ARKit shape: a table that a person can review and correct."""

from __future__ import annotations

import difflib
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile

from engine.errors import EditError
from engine.take import SHAPES

EXACT, RESPELT, OTHER_NAME = (
    1.0,
    0.99,
    0.95,
)  # likeness of ARKit's own name, of another spelling, of another word for it
SURE = 0.8  # likeness from which a guess is taken without asking
WORTH_SHOWING = 0.6
FEWEST_SHARING = 4  # names of a file that begin alike, for that to be no part of them
LONGEST = 64  # letters; comparing takes time that grows with their square
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
    likeness : 0..1; 1 is ARKit's own name, or a person's word
    rival : the ARKit shape that it is like but another name of the file has; empty where it lost to none
    """

    source: str
    shape: str
    likeness: float
    rival: str = ""

    @property
    def sure(self) -> bool:
        """Whether the guess is taken without asking."""
        return bool(self.shape) and self.likeness >= SURE

    @property
    def certain(self) -> bool:
        """Whether there is nothing to review: the name is ARKit's, however it is spelt."""
        return bool(self.shape) and self.likeness >= RESPELT

    @property
    def how(self) -> str:
        """What a reviewer reads: why the shape was taken or left out."""
        if self.rival:
            return f"left out: another name has {self.rival}"
        if not self.shape:
            return "left out: like no shape"
        if not self.sure:
            return "left out: not alike enough"
        return "same name" if self.certain else "by likeness"


def reviewed(matches: Iterable[Match]) -> list[Match]:
    """Return the rows that a person should look at: by likeness, left out, or several names for one shape."""
    rows = list(matches)
    users = Counter(row.shape for row in rows if row.sure)
    return [row for row in rows if not row.certain or users[row.shape] > 1]


def plain(name: str, *, shared: int = 0) -> str:
    """Return a name without case, separators, prefixes and numbering, sides in full and at the end.

    `shared` words before it, such as a mesh's name, are left out.
    """
    lower = _words(name)[shared:]
    while len(lower) > 1 and lower[0] in _LEADING:
        lower = lower[1:]
    sides = [_SIDE.get(word, word) for word in lower if _SIDE.get(word, word) in ("left", "right")]
    rest = [word for word in lower if _SIDE.get(word, word) not in ("left", "right")]
    return "".join(rest + sides)


def _words(name: str) -> list[str]:
    last = re.split(r"[.:|/]", name)[-1] if not re.search(r"[.:|/]\d*$", name) else name
    words = re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+", last)
    return [word.lower() for word in words if not word.isdigit()]


_PLAIN = {plain(shape): shape for shape in SHAPES}
_KNOWN = _PLAIN | {other: _PLAIN[name] for name, others in OTHER_NAMES.items() for other in others}
_SPLIT = {plain(f"{shape}{side}"): shape for shape in HALVES for side in ("Left", "Right")}
_KNOWN |= _SPLIT


def match_names(names: Iterable[str]) -> list[Match]:
    """Return a row for each of the file's shapes: the ARKit shape most like it, or none.

    Where several names want one shape, the likeliest has it wherever it stands in the file: ARKit's own name before
    another spelling, that before another word, that before a likeness. The two halves of a shape share it.
    """
    names = list(names)
    shared = _shared(names)
    guesses = [_guess(name, shared) for name in names]
    order = sorted(range(len(guesses)), key=lambda row: -guesses[row].likeness)
    taken: dict[str, Match] = {}
    for row in order:
        guess = guesses[row]
        first = taken.setdefault(guess.shape, guess) if guess.shape else guess
        if first is not guess and not _halves(guess, first, shared):
            guesses[row] = replace(guess, shape="", likeness=0.0, rival=guess.shape if guess.sure else "")
    return guesses


def _shared(names: Sequence[str]) -> int:
    """Return how many words stand before every name, as a mesh's own does; 0 where any is a known name as it is."""
    if len(names) < FEWEST_SHARING or any(plain(name) in _KNOWN for name in names):
        return 0
    heads = zip(*(_words(name)[:-1] for name in names), strict=False)
    return sum(1 for _ in takewhile(lambda words: len(set(words)) == 1, heads))


def _guess(name: str, shared: int) -> Match:
    key = plain(name, shared=shared)
    if name in SHAPES:
        return Match(name, name, EXACT)
    if key in _PLAIN:
        return Match(name, _PLAIN[key], RESPELT)
    if key in _KNOWN:
        return Match(name, _KNOWN[key], RESPELT if key in _SPLIT else OTHER_NAME)
    side = key.removesuffix("left").removesuffix("right") != key
    # A shape's side is certain where it is written: likeness of the rest must not turn left into right.
    ending = "left" if key.endswith("left") else "right"
    pool = [known for known in _KNOWN if (known.endswith(ending) if side else not known.endswith(("left", "right")))]
    likeness, best = _most_alike(key, pool)
    return Match(name, _KNOWN[best], round(likeness, 3)) if likeness >= WORTH_SHOWING else Match(name, "", 0.0)


def _most_alike(key: str, pool: Iterable[str]) -> tuple[float, str]:
    """Return the likeness, 0 to below that of a known name, and which name; long names are damage and like nothing."""
    best = (0.0, "")
    matcher = difflib.SequenceMatcher(b=key)
    for known in pool if len(key) <= LONGEST else ():
        matcher.set_seq1(known)
        bar = max(best[0], WORTH_SHOWING)
        if matcher.real_quick_ratio() > bar and matcher.quick_ratio() > bar:
            best = max(best, (matcher.ratio(), known))
    return OTHER_NAME * best[0], best[1]


def _halves(one: Match, other: Match, shared: int) -> bool:
    keys = sorted(plain(row.source, shared=shared) for row in (one, other))
    return keys == [f"{plain(one.shape)}left", f"{plain(one.shape)}right"]


def corrected(matches: Iterable[Match], changes: Mapping[str, str]) -> list[Match]:
    """Return the table after a review: `changes` gives the ARKit shape, or nothing, for names of the file.

    Raises `EditError` for a name the file has not or a shape that is not ARKit's.
    """
    rows = list(matches)
    known = {row.source for row in rows}
    for source, shape in changes.items():
        if source not in known:
            raise EditError(f"The file has no shape called {source[:60]!r}.")
        if shape and shape not in SHAPES:
            raise EditError(f"There is no shape called {shape[:60]!r}.", "Shapes have ARKit names, such as jawOpen.")
    return [Match(row.source, changes[row.source], 1.0) if row.source in changes else row for row in rows]
