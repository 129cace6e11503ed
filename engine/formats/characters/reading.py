"""How a head of another program is read where a person corrects what was detected."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from engine.errors import EditError
from engine.formats.characters import read
from engine.formats.characters.frame import UNITS_MM, UPS, Frame, detect
from engine.formats.characters.names import corrected, match_names
from engine.formats.characters.raw import RawCharacter

if TYPE_CHECKING:
    from engine.formats.characters.assemble import Import


@dataclass(frozen=True)
class Reading:
    """A person's corrections; what is empty or None is detected.

    Attributes
    ----------
    unit : a key of `frame.UNITS_MM`
    up : the file's upward axis, one of `frame.UPS`
    facing_deg : how far the face is turned, as `frame.Frame` has it
    names : ARKit shape by the file's name of a shape; empty leaves it out
    """

    unit: str = ""
    up: str = ""
    facing_deg: float | None = None
    names: Mapping[str, str] = field(default_factory=dict)

    def stored(self) -> dict[str, Any]:
        """Return what JSON can hold of it, nothing where nothing was corrected."""
        pairs = {"unit": self.unit, "up": self.up, "facing_deg": self.facing_deg, "names": dict(self.names)}
        return {key: value for key, value in pairs.items() if value not in ("", None, {})}

    @staticmethod
    def restored(stored: object) -> Reading:
        """Return a reading from what `stored` gave; what a damaged project holds instead is detected anew."""
        if not isinstance(stored, Mapping):
            return Reading()
        unit, up, turn, names = (stored.get(key) for key in ("unit", "up", "facing_deg", "names"))
        return Reading(
            unit if isinstance(unit, str) else "",
            up if isinstance(up, str) else "",
            float(turn) if isinstance(turn, int | float) else None,
            {str(name): str(shape) for name, shape in names.items()} if isinstance(names, Mapping) else {},
        )


def import_head(path: Path, reading: Reading = Reading(), landmarks: Mapping[str, int] | None = None) -> Import:
    """Read a head from a file of another program as corrected; raises `EngineError` with one plain sentence."""
    return assembled(read(path), reading, landmarks)


def assembled(raw: RawCharacter, reading: Reading, landmarks: Mapping[str, int] | None = None) -> Import:
    """Make a character of a file's mesh as corrected; raises `EngineError`, for a unit or an axis that there is not too."""
    from engine.formats.characters.assemble import assemble

    for value, known, what in ((reading.unit, tuple(UNITS_MM), "unit"), (reading.up, UPS, "upward axis")):
        if value and value not in known:
            raise EditError(f"There is no {what} called {value[:20]!r}.", f"Use one of: {', '.join(known)}.")
    turn = reading.facing_deg
    if turn is not None and not abs(turn) <= 360:
        raise EditError("A face is turned by -360 to 360 degrees.")
    matches = corrected(match_names(raw.shapes), reading.names)
    found = detect(raw, matches, unit=reading.unit, up=reading.up)
    frame = found.frame if turn is None else Frame(found.frame.unit, found.frame.up, float(np.round(turn, 6)))
    return assemble(raw, frame=frame, matches=matches, landmarks=landmarks, found=found)
