"""From a file's mesh to a character of ours: unit, axes, shapes, landmarks, each detected, shown and correctable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from engine.character import Character, bundled
from engine.errors import FormatError
from engine.formats.characters.names import Match, match_names
from engine.formats.characters.raw import RawCharacter
from engine.manifold.drive import parts_of
from engine.manifold.pose import fit_similarity
from engine.take import SHAPE_INDEX, SHAPES, Array

UNITS_MM = {"mm": 1.0, "cm": 10.0, "in": 25.4, "m": 1000.0}
HEAD_MM = (150.0, 700.0)  # height of a head, from chin-to-crown alone to head and shoulders
TYPICAL_MM = 280.0
UP = ("y", "z")
SKIN = (205, 165, 145)


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
        np.full((len(neutral), 3), SKIN, np.uint8),
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
            f"{len(doubtful)} names are like a shape but not alike enough to be taken: {', '.join(doubtful[:4])}."
        )
    return sentences


def _require_inside(landmarks: Mapping[str, int], raw: RawCharacter) -> None:
    for name, vertex in landmarks.items():
        if not 0 <= vertex < len(raw.vertices):
            raise FormatError(f"The landmark {name!r} names vertex {vertex}; {raw.name} has {len(raw.vertices)}.")


def transfer_landmarks(
    neutral: Array, triangles: npt.NDArray[np.int32], deltas: npt.NDArray[np.float32], given: Mapping[str, int]
) -> tuple[dict[str, int], dict[str, float]]:
    """Find the bundled head's landmarks on another head in our frame: rigid fit with scale, then the nearest vertex.

    Where both heads have shapes, the fit pairs the places that move most in each (the jaw's opening finds the chin,
    a blink its lid); landmarks picked by hand take part in the fit and stay as they are. Upper and lower lip and lid
    lie at one place, so the nearest vertex is sought among those that move as the landmark does.
    """
    head = bundled()
    source = head.neutral.astype(np.float64)
    fitted = _fit(source, head, neutral, deltas, given)
    found, away = dict(given), dict.fromkeys(given, 0.0)
    skin = np.flatnonzero(_largest_part(triangles, len(neutral)))
    size = np.linalg.norm(np.ptp(source, axis=0)) / 20
    for name, vertex in head.landmarks.items():
        if name in given:
            continue
        gap = np.linalg.norm(neutral[skin] - fitted[vertex], axis=1)
        unlike = _unlike(head.deltas[:, vertex], deltas[:, skin]) if np.abs(deltas).any() else np.zeros(len(skin))
        best = int(np.argmin(gap + size * unlike))
        found[name], away[name] = int(skin[best]), float(gap[best])
    return found, away


def _fit(
    source: Array,
    head: Character,
    neutral: Array,
    deltas: npt.NDArray[np.float32],
    given: Mapping[str, int],
) -> Array:
    """Return the bundled head's vertices laid onto another head, (n, 3)."""
    pairs = [
        (source[head.landmarks[name]], neutral[vertex]) for name, vertex in given.items() if name in head.landmarks
    ]
    for shape in range(len(SHAPES)):
        ours, theirs = (_centre_of_motion(v, d[shape]) for v, d in ((source, head.deltas), (neutral, deltas)))
        if ours is not None and theirs is not None:
            pairs.append((ours, theirs))
    if len(pairs) >= 4:
        start, end = (np.array(side) for side in zip(*pairs, strict=True))
        placed = fit_similarity(start, end[None], mirrored=False).apply(source)[0]
    else:
        scale = np.ptp(neutral[:, 1]) / np.ptp(source[:, 1])
        placed = (source - _middle(source)) * scale + _middle(neutral)
    return _to_surface(placed, np.flatnonzero(_largest_part(head.triangles, len(source))), neutral)


def _to_surface(placed: Array, skin: npt.NDArray[np.int64], neutral: Array, *, rounds: int = 12) -> Array:
    """Refine a fit by pairing each vertex of the skin with the nearest one of the other head (ICP)."""
    tree = KDTree(neutral)
    sample = placed[skin[:: max(1, len(skin) // 1500)]]
    laid = placed
    for _ in range(rounds):
        away, found = tree.query(sample)
        nearest = np.asarray(found, np.int64)
        close = away <= np.percentile(away, 80)
        motion = fit_similarity(sample[close], neutral[nearest[close]][None], mirrored=False)
        sample, laid = motion.apply(sample)[0], motion.apply(laid)[0]
    return laid


def _middle(points: Array) -> Array:
    return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2)


def _centre_of_motion(vertices: Array, delta: npt.NDArray[np.float32]) -> Array | None:
    """Return where a shape moves most, (3,); none for a shape the head has not."""
    travel = np.linalg.norm(delta, axis=1).astype(np.float64)
    if travel.max(initial=0.0) <= 0:
        return None
    share = np.where(travel > travel.max() / 2, travel, 0.0)
    return np.asarray(share @ vertices / share.sum())


def _largest_part(triangles: npt.NDArray[np.int32], vertices: int) -> npt.NDArray[np.bool_]:
    parts = parts_of(triangles, vertices)
    return np.asarray(parts == np.argmax(np.bincount(parts)))


def _unlike(one: npt.NDArray[np.float32], many: npt.NDArray[np.float32]) -> Array:
    """Return how differently vertices move from one vertex, 0..2, for deltas (52, 3) and (52, n, 3)."""
    flat, others = one.ravel(), many.transpose(1, 0, 2).reshape(many.shape[1], -1)
    length = np.linalg.norm(others, axis=1) * np.linalg.norm(flat)
    return np.asarray(1.0 - (others @ flat) / np.maximum(length, 1e-9), np.float64)
