"""From a file's mesh to a character of ours: unit, axes, shapes, landmarks, each detected, shown and correctable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from engine.character import Character, bundled
from engine.errors import EditError, FormatError
from engine.formats.base.budget import BUDGET
from engine.formats.characters.colouring import MOST_PARTS, colours_of
from engine.formats.characters.frame import TYPICAL_MM, UNITS_MM, Detection, Frame, detect
from engine.formats.characters.landmarks import transfer_landmarks
from engine.formats.characters.names import Match, match_names
from engine.formats.characters.raw import RawCharacter
from engine.framing import LEAST_SHARE, share_seen
from engine.mesh import parts_of
from engine.take import SHAPE_INDEX, SHAPES, Array
from engine.words import counted

OTHER_VALUES = 4  # coordinates beside the shapes, of each vertex
SMALLEST_MM, LARGEST_MM = 20.0, 5000.0  # height of a head alone, of a giant's body


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


def detect_frame(raw: RawCharacter, matches: Sequence[Match] | None = None) -> Frame:
    """Guess a file's unit and axes by its face, as `frame.detect` does."""
    return detect(raw, match_names(raw.shapes) if matches is None else matches).frame


def assemble(
    raw: RawCharacter,
    *,
    frame: Frame | None = None,
    matches: Sequence[Match] | None = None,
    landmarks: Mapping[str, int] | None = None,
    found: Detection | None = None,
) -> Import:
    """Make a character of a file's mesh; what is not given is detected.

    Parameters
    ----------
    raw : from `characters.read`
    frame : unit and axes of the file
    matches : what each of its shapes is taken for
    landmarks : vertices that were placed by hand, by name and in the file's numbers
    found : what `frame.detect` said of the same

    Raises
    ------
    FormatError : for a landmark outside the mesh, and for a head that would not be seen
    EditError : for a landmark that no head has
    """
    rows = list(matches) if matches is not None else match_names(raw.shapes)
    found = found or detect(raw, rows)
    frame = frame or found.frame
    neutral = raw.vertices @ frame.matrix
    used = [row for row in rows if row.sure]
    BUDGET.require(raw.name, values=3 * len(neutral) * (len(used) + OTHER_VALUES))
    deltas = np.zeros((len(SHAPES), len(neutral), 3), np.float32)
    turn = frame.matrix.astype(np.float32)
    for row in used:
        deltas[SHAPE_INDEX[row.shape]] += raw.shapes[row.source] @ turn
    given = _placed(landmarks or {}, raw)
    _require_size(neutral, raw, frame, found)
    places, away = transfer_landmarks(neutral, raw.triangles, deltas, given)
    character = Character(
        neutral.astype(np.float32),
        raw.triangles,
        deltas,
        _colours(neutral, raw, places),
        places,
        raw.name,
        split=raw.split,
        split_triangles=raw.split_triangles,
    )
    if share_seen(character) < LEAST_SHARE:
        raise _unseen(raw, frame, found)
    return Import(character, frame, rows, away, (*raw.notices, *_notices(frame, rows, raw, found)))


def _colours(neutral: Array, raw: RawCharacter, places: Mapping[str, int]) -> npt.NDArray[np.uint8]:
    """Return colours, (n, 3), told by the parts that the file has; by those that welding made where it split every face."""
    if not len(raw.split) or parts_of(raw.split_triangles, len(raw.split)).max() >= MOST_PARTS:
        return colours_of(neutral, raw.triangles, places)
    _, first = np.unique(raw.split, return_index=True)
    of_file = colours_of(
        neutral[raw.split], raw.split_triangles, {name: int(first[vertex]) for name, vertex in places.items()}
    )
    return np.asarray(of_file[first])


def _require_size(neutral: Array, raw: RawCharacter, frame: Frame, found: Detection) -> None:
    """Refuse a mesh that is a thousand times too large or small before landmarks are looked for on it."""
    height = float(np.ptp(neutral[:, 1]))
    if not SMALLEST_MM <= height <= LARGEST_MM:
        raise _unseen(raw, frame, found)


def _unseen(raw: RawCharacter, frame: Frame, found: Detection) -> FormatError:
    height = float(np.ptp(raw.vertices @ frame.matrix, axis=0)[1])
    size = found.apart if np.isfinite(found.apart) else height / UNITS_MM[frame.unit] / TYPICAL_MM
    unit = min(UNITS_MM, key=lambda name: abs(np.log(max(size, 1e-300) * UNITS_MM[name])))
    advice = f"Choose its unit and axes by hand: {unit} would fit its face." if unit != frame.unit else ""
    return FormatError(
        f"{raw.name[:60]} would hardly be seen: read in {frame.unit}, {frame.up} up, it is {height / 1000:.3g} m high.",
        advice or "Choose its unit and axes by hand, or place its landmarks.",
    )


def _notices(frame: Frame, rows: Sequence[Match], raw: RawCharacter, found: Detection) -> list[str]:
    sentences = [f"Read in {frame.unit}, {frame.up} up, facing {frame.facing}."]
    if found.exchanged:
        sentences.append(
            "Its left shapes lie on its right: the file may be mirrored, or name sides as a viewer sees them."
        )
    if len(raw.split):
        sentences.append(
            f"{len(raw.split):,} vertices of the file are {len(raw.vertices):,} places; seams were closed."
        )
    missing = [shape for shape in SHAPES if not any(row.sure and row.shape == shape for row in rows)]
    if not raw.shapes:
        sentences.append("The mesh has no shapes: it can be driven from points, not from weights.")
    elif missing:
        shown = ", ".join(missing[:6]) + (" and others" if len(missing) > 6 else "")
        sentences.append(f"{len(missing)} of {len(SHAPES)} shapes were not found: {shown}.")
    doubtful = [row.source for row in rows if row.shape and not row.sure]
    if doubtful:
        sentences.append(
            f"{counted(len(doubtful), 'name')} like a shape but not alike enough to be taken: {_few(doubtful)}."
        )
    guessed = [f"{row.source} for {row.shape}" for row in rows if row.sure and not row.certain]
    if guessed:
        sentences.append(f"Taken by likeness: {_few(guessed)}.")
    rivals = [f"{row.source} ({row.rival} is there)" for row in rows if row.rival]
    if rivals:
        sentences.append(f"Left out: {_few(rivals)}.")
    return sentences


def _few(texts: Sequence[str]) -> str:
    shown = ", ".join(text[:60] for text in texts[:4])
    return shown + (f" and {len(texts) - 4} more" if len(texts) > 4 else "")


def _placed(landmarks: Mapping[str, int], raw: RawCharacter) -> dict[str, int]:
    """Return landmarks by vertex of the welded mesh; raises for a name or a number that there is not."""
    count, known = len(raw.split) or len(raw.vertices), bundled().landmarks
    for name, vertex in landmarks.items():
        if name not in known:
            raise EditError(f"There is no landmark called {name[:60]!r}.", f"There are: {', '.join(known)}.")
        if not 0 <= vertex < count:
            raise FormatError(f"The landmark {name!r} names vertex {vertex}; {raw.name} has {count}.")
    return {name: int(raw.split[vertex]) if len(raw.split) else int(vertex) for name, vertex in landmarks.items()}
