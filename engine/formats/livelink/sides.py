"""Left and right of mouth and jaw: the app records each under the other's name, most other writers do not."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from engine.formats.base.reading import Sides
from engine.take import SHAPE_INDEX, Array, Mask

EXCHANGED = (("mouthLeft", "mouthRight"), ("jawLeft", "jawRight"))
# Shapes of one side that pull the mouth to that side, so that their asymmetry goes with its way. The jaw tells nothing:
# it goes with the mouth in recordings, and against it in others.
PULLING = ("mouthDimple", "mouthStretch", "cheekSquint", "mouthUpperUp")
FEWEST_ROWS = 30
LEAST_SIDEWAYS, LEAST_UNEVEN = 0.003, 0.002  # standard deviation of a weight below which nothing is told
FEWEST_PAIRS = 3
# Correlations over eight recordings: mean -.26 and less in seven, -.21 in the shortest; over a stream by name: +.94.
SURE, LIKELY = 0.5, 0.35  # mean correlation
LEAST_AGREEMENT = 0.25  # of all pairs but one, for a file to be taken as named


@dataclass(frozen=True)
class Judgement:
    """What the motion of a file tells of its sides.

    Attributes
    ----------
    recorded : whether mouth and jaw are taken as the app records them
    agreement : mean correlation of the mouth's way sideways with the asymmetry of its own side, -1..1; None where there
        is too little motion to tell. The app's recordings are below zero, files by name above.
    """

    recorded: bool = True
    agreement: float | None = None

    @property
    def confidence(self) -> str:
        """How sure it is, in a word."""
        if self.agreement is None:
            return "no sideways motion to tell by"
        strength = self.agreement if not self.recorded else -self.agreement
        return "sure" if strength >= SURE else "likely" if strength >= LIKELY else "uncertain"


def judge(curves: Mapping[str, Array], seen: Mask) -> Judgement:
    """Return whose sides a file's columns are named by, from what its motion tells.

    A mouth that goes to one side is pulled by that side's dimple, stretch, squint and upper lip. Where the columns go
    against their own side, the app recorded them; where all but one of at least three clearly go with it, they are as
    named. Without clear evidence the file is taken as the app's, which most are.

    Parameters
    ----------
    curves : (rows,) weights by shape, each as the file names it
    seen : (rows,) bool, rows with a face
    """
    if int(seen.sum()) < FEWEST_ROWS or not all(name in curves for name in EXCHANGED[0]):
        return Judgement()
    sideways = (curves["mouthLeft"] - curves["mouthRight"])[seen]
    if sideways.std() < LEAST_SIDEWAYS:
        return Judgement()
    found = []
    for shape in PULLING:
        uneven = (curves[f"{shape}Left"] - curves[f"{shape}Right"])[seen]
        if uneven.std() > LEAST_UNEVEN:
            found.append(float(np.corrcoef(sideways, uneven)[0, 1]))
    if len(found) < 2:
        return Judgement()
    mean = float(np.mean(found))
    agreeing = sum(each > LEAST_AGREEMENT for each in found)
    named = len(found) >= FEWEST_PAIRS and mean > LIKELY and agreeing >= len(found) - 1 and min(found) > -0.1
    return Judgement(not named, mean)


def recorded_name(shape: str, *, swapped: bool) -> str:
    """Return the shape whose values stand in a file under the name `shape`."""
    if swapped:
        for left, right in EXCHANGED:
            if shape in (left, right):
                return right if shape == left else left
    return shape


def exchange(weights: Array) -> Array:
    """Return weights, (frames, 52), with left and right of mouth and jaw exchanged; doing it twice changes nothing."""
    places = np.arange(weights.shape[1])
    for left, right in EXCHANGED:
        a, b = SHAPE_INDEX[left], SHAPE_INDEX[right]
        places[[a, b]] = places[[b, a]]
    exchanged = weights[:, places]
    exchanged.flags.writeable = False
    return exchanged


def exchange_cells(lines: Iterable[bytes], header: Sequence[str]) -> Iterator[bytes]:
    """Yield the lines of a file with the texts under left and right of mouth and jaw exchanged; each is a whole line."""
    places = {name.strip().lower(): place for place, name in enumerate(header)}
    pairs = [(places.get(left.lower()), places.get(right.lower())) for left, right in EXCHANGED]
    for number, line in enumerate(lines):
        body = line.rstrip(b"\r\n")
        cells = body.split(b",") if number else [body]
        for left, right in pairs:
            if left is not None and right is not None and max(left, right) < len(cells):
                cells[left], cells[right] = cells[right], cells[left]
        yield b",".join(cells) + line[len(body) :]


def written_recorded(sides: Sides, *, swapped: bool) -> bool:
    """Whether a file is written as the app records: as it was read, unless something else is asked for."""
    return swapped if sides == "automatic" else sides == "recorded"
