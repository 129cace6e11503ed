"""The parts of the face that a span may be limited to."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from engine.errors import EditError
from engine.take import SHAPES, Mask

_LOWER = ("jaw", "mouth", "cheekPuff", "tongue")
_CENTRAL = ("jawLeft", "jawRight", "mouthLeft", "mouthRight")  # directions of the whole mouth, not sides of the face


def _where(matches: Callable[[str], bool]) -> Mask:
    mask = np.array([matches(name) for name in SHAPES])
    mask.flags.writeable = False
    return mask


REGIONS: dict[str, Mask] = {
    "face": _where(lambda name: True),
    "lower": _where(lambda name: name.startswith(_LOWER)),
    "upper": _where(lambda name: not name.startswith(_LOWER)),
    "eyes": _where(lambda name: name.startswith("eye")),
    "left": _where(lambda name: name.endswith("Left") and name not in _CENTRAL),
    "right": _where(lambda name: name.endswith("Right") and name not in _CENTRAL),
}


def region_shapes(name: str) -> Mask:
    """Return the shapes of a region, (52,) bool; raises `EditError` that lists the names."""
    try:
        return REGIONS[name]
    except KeyError:
        raise EditError(f"There is no region called {name!r}.", f"Regions are: {', '.join(REGIONS)}.") from None
