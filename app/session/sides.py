"""The sides of the preview: heads with numbered markers on their skin, or a capture's points alone."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from engine.character import Character
from engine.take import Array


@dataclass(frozen=True, eq=False)
class Dot:
    """A marker on a side: the vertex it sits on, or else its place, (3,) mm; NaN where it is not seen."""

    name: str
    vertex: int = -1
    place: Array = field(default_factory=lambda: np.full(3, np.nan))
    number: str = ""
    chosen: bool = False


@dataclass(frozen=True, eq=False)
class Side:
    """One side of the preview.

    Attributes
    ----------
    label : what it says in its corner
    weights : (52,) of the face, or None where points stand alone
    head : whose head the face is on, or None for the bundled one
    dots : drawn over it
    box : lowest and highest corner, (3,) mm each, of what is framed where there is no head
    pickable : whether a click names the vertex under it
    hint : what it says in its middle where there is nothing to see yet
    """

    label: str
    weights: Array | None
    head: Character | None = None
    dots: tuple[Dot, ...] = ()
    box: tuple[Array, Array] | None = None
    pickable: bool = False
    hint: str = ""
