"""From a file's mesh to a character of ours: unit, axes, shapes, landmarks, each detected, shown and correctable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from engine.character import Character
from engine.errors import FormatError
from engine.formats.characters.colouring import colours_of
from engine.formats.characters.landmarks import transfer_landmarks
from engine.formats.characters.names import Match, match_names
from engine.formats.characters.raw import RawCharacter
from engine.take import SHAPE_INDEX, SHAPES, Array
from engine.words import counted

UNITS_MM = {"mm": 1.0, "cm": 10.0, "in": 25.4, "m": 1000.0}
HEAD_MM = (150.0, 700.0)  # height of a head, from chin-to-crown alone to head and shoulders
TYPICAL_MM = 280.0
UP = ("y", "z")


@dataclass(frozen=True)
class Frame:
    """How a file's coordinates become ours: millimetres, Y up, Z forward.

    Attributes
    ----------
    unit : name of the file's unit, a key of UNITS_MM
    up : the file's upward axis, y or z
    """

    unit: str
    up: str

    @property
    def matrix(self) -> Array:
        """Return the (3, 3) that takes the file's rows to ours."""
        turn = np.eye(3) if self.up == "y" else np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
        return np.asarray(UNITS_MM[self.unit] * turn)


@dataclass(frozen=True, eq=False)
class Import:
    """A character read from a file, with everything that was guessed on the way.

    Attributes
    ----------
    character : in our frame
    frame : unit and upward axis that were detected or given
    matches : what each of the file's shapes was taken for
    landmark_mm : distance from each transferred landmark to the surface, by name
    notices : sentences that the user should see
    """

    character: Character
    frame: Frame
    matches: list[Match]
    landmark_mm: dict[str, float]
    notices: tuple[str, ...] = field(default=())


def detect_frame(raw: RawCharacter) -> Frame:
    """Guess unit and upward axis: a head is a few hundred mm high.

    The jaw opens downwards and back: with Y up that is against Y, with Z up (facing against Y) along it. Without that
    shape the upward axis is the longer of the two.
    """
    size = np.ptp(raw.vertices, axis=0)
    jaw = [delta for name, delta in raw.shapes.items() if any(m.shape == "jawOpen" for m in match_names([name]))]
    upright = sum(float(delta[:, 1].sum()) for delta in jaw) < 0 if jaw else size[1] >= size[2]
    up = "y" if upright else "z"
    height = size[1 if up == "y" else 2]
    inside = [unit for unit, mm in UNITS_MM.items() if HEAD_MM[0] <= height * mm <= HEAD_MM[1]]
    unit = min(inside or UNITS_MM, key=lambda unit: abs(np.log(height * UNITS_MM[unit] / TYPICAL_MM)))
    return Frame(unit, up)


def assemble(
    raw: RawCharacter,
    *,
    frame: Frame | None = None,
    matches: Sequence[Match] | None = None,
    landmarks: Mapping[str, int] | None = None,
) -> Import:
    """Make a character of a file's mesh; what is not given is detected.

    Raises `FormatError` for a landmark outside the mesh.
    """
    frame = frame or detect_frame(raw)
    rows = list(matches) if matches is not None else match_names(raw.shapes)
    neutral = raw.vertices @ frame.matrix
    deltas = np.zeros((len(SHAPES), len(neutral), 3), np.float32)
    used = [row for row in rows if row.sure]
    for row in used:
        deltas[SHAPE_INDEX[row.shape]] += raw.shapes[row.source] @ frame.matrix.astype(np.float32)
    _require_inside(landmarks or {}, raw)
    given = {name: int(vertex) for name, vertex in (landmarks or {}).items()}
    found, away = transfer_landmarks(neutral, raw.triangles, deltas, given)
    character = Character(
        neutral.astype(np.float32),
        raw.triangles,
        deltas,
        colours_of(neutral, raw.triangles, found),
        found,
        raw.name,
    )
    return Import(character, frame, rows, away, (*raw.notices, *_notices(frame, rows, raw)))


def _notices(frame: Frame, rows: Sequence[Match], raw: RawCharacter) -> list[str]:
    sentences = [f"Read in {frame.unit}, {frame.up} up."]
    missing = [shape for shape in SHAPES if not any(row.sure and row.shape == shape for row in rows)]
    if not raw.shapes:
        sentences.append("The mesh has no shapes: it can be driven from points, not from weights.")
    elif missing:
        shown = ", ".join(missing[:6]) + (" and others" if len(missing) > 6 else "")
        sentences.append(f"{len(missing)} of {len(SHAPES)} shapes were not found: {shown}.")
    doubtful = [row.source for row in rows if row.shape and not row.sure]
    if doubtful:
        sentences.append(
            f"{counted(len(doubtful), 'name')} like a shape but not alike enough to be taken: {', '.join(doubtful[:4])}."
        )
    return sentences


def _require_inside(landmarks: Mapping[str, int], raw: RawCharacter) -> None:
    for name, vertex in landmarks.items():
        if not 0 <= vertex < len(raw.vertices):
            raise FormatError(f"The landmark {name!r} names vertex {vertex}; {raw.name} has {len(raw.vertices)}.")
