"""Colours for a head whose file has none that we read: skin, and eyes, teeth and mouth told by where their parts lie."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from engine.mesh import parts_of
from engine.take import Array

Rows = npt.NDArray[np.int64]
FEWEST_OF_PART, MOST_PARTS = 4, 400  # vertices of a part that is painted, parts
SKIN, MOUTH, TOOTH, LASH = (205, 165, 145), (150, 75, 75), (232, 226, 212), (122, 94, 82)
WHITE, IRIS, PUPIL = (236, 234, 230), (88, 122, 138), (20, 20, 24)
IRIS_DEG, PUPIL_DEG, SOFT_DEG = 26.0, 11.0, 8.0  # half angles about the eyeball's centre, and the width of their edges
ROUND = 1.3  # width by height of an eyeball, or the other way round
EYE_MM = 12.0  # how far from the lids' middle the middle of a part of the eye is at most
SHELL_SHARE = 0.3  # of an eyeball's radius: how unevenly far from its centre a part may be and still lie on it
LASH_VERTICES, LASH_RATIO = 400, 3.2  # at most; width by height, at least, of one that hugs the eye
_MOUTH = ("mouth_left", "mouth_right", "lip_inner_upper")
TOOTH_SHARE = 0.45  # of the mouth's width: a part wider and deeper than that is no tooth


def colours_of(points: Array, triangles: npt.NDArray[np.int32], landmarks: Mapping[str, int]) -> npt.NDArray[np.uint8]:
    """Return sRGB colours, (n, 3), of a head's vertices, (n, 3) mm in our frame; all skin where landmarks are missing."""
    colours = np.full((len(points), 3), SKIN, np.uint8)
    if not {*_MOUTH, *_lids("left"), *_lids("right")} <= set(landmarks):
        return colours
    parts = parts_of(triangles, len(points))
    others = _all_but(int(parts[landmarks["lip_inner_upper"]]), parts)
    for side in ("left", "right"):
        _paint_eye(colours, others, points, points[[landmarks[name] for name in _lids(side)]])
    _paint_mouth(colours, others, points, points[[landmarks[name] for name in _MOUTH]])
    return colours


def _all_but(skin: int, parts: Rows) -> list[Rows]:
    """Return the rows of each part but the skin, the largest MOST_PARTS of them; a triangle apart is no part."""
    order = np.argsort(parts, kind="stable")
    counts = np.bincount(parts)
    ends = np.cumsum(counts)
    chosen = np.flatnonzero(counts >= FEWEST_OF_PART)
    chosen = chosen[chosen != skin]
    largest = chosen[np.argsort(-counts[chosen], kind="stable")][:MOST_PARTS]
    return [order[ends[part] - counts[part] : ends[part]] for part in sorted(largest)]


def _lids(side: str) -> tuple[str, str]:
    return f"lid_upper_{side}", f"lid_lower_{side}"


def _paint_eye(colours: npt.NDArray[np.uint8], parts: list[Rows], points: Array, lids: Array) -> None:
    """Paint the parts about the lids, (2, 3) mm: balls, the shells on them, and the lashes above."""
    between = lids.mean(axis=0)
    near = [rows for rows in parts if np.abs(_middle(points[rows]) - between)[:2].max() < EYE_MM]
    balls = [ball for rows in near if (ball := _ball(points[rows])) is not None]
    if not balls:
        return
    centre, radius = balls[0]
    for rows in near:
        away, box = points[rows] - centre, np.ptp(points[rows], axis=0)
        if np.ptp(np.linalg.norm(away, axis=1)) < SHELL_SHARE * radius and box[0] < LASH_RATIO * box[1]:
            colours[rows] = _eyeball(away)
        elif _middle(points[rows])[1] > between[1] and len(rows) < LASH_VERTICES:
            colours[rows] = LASH


def _ball(points: Array) -> tuple[Array, float] | None:
    """Return centre and radius of the sphere that points, (n, 3), lie on; none where they are not round seen from ahead."""
    box = np.ptp(points, axis=0)
    if len(points) < 4 or max(box[:2]) > ROUND * min(box[:2]):
        return None
    system = np.hstack([2 * points, np.ones((len(points), 1))])
    solution = np.linalg.lstsq(system, (points**2).sum(axis=1), rcond=None)[0]
    centre = solution[:3]
    away = np.linalg.norm(points - centre, axis=1)
    return (centre, float(away.mean())) if np.ptp(away) < SHELL_SHARE * away.mean() else None


def _paint_mouth(colours: npt.NDArray[np.uint8], parts: list[Rows], points: Array, mouth: Array) -> None:
    """Paint the parts behind the lips: teeth are narrow or shallow, the rest is not. `mouth` is its corners and a lip."""
    width, lip = float(np.ptp(mouth[:2, 0])), mouth[2]
    for rows in parts:
        middle, box = _middle(points[rows]), np.ptp(points[rows], axis=0)
        if np.abs(middle - lip)[:2].max() < 0.7 * width and middle[2] < lip[2]:
            colours[rows] = TOOTH if min(box[0], box[2]) < TOOTH_SHARE * width else MOUTH


def _middle(points: Array) -> Array:
    return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2)


def _eyeball(away: Array) -> npt.NDArray[np.uint8]:
    """Return colours, (n, 3), of an eyeball's vertices, (n, 3) from its centre; soft edges hide that they are few."""
    ahead = away[:, 2] / np.maximum(np.linalg.norm(away, axis=1), 1e-9)
    angle = np.degrees(np.arccos(np.clip(ahead, -1.0, 1.0)))[:, None]
    iris = np.clip((IRIS_DEG - angle) / SOFT_DEG + 0.5, 0.0, 1.0)
    pupil = np.clip((PUPIL_DEG - angle) / SOFT_DEG + 0.5, 0.0, 1.0)
    painted = np.array(WHITE) * (1 - iris) + np.array(IRIS) * iris
    return np.asarray((painted * (1 - pupil) + np.array(PUPIL) * pupil).round(), np.uint8)
