"""Fits the sculpture to a measured head: where its solids lie, and how its handles move in each shape."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from engine.lab.sculpting import clay, handles
from engine.lab.sculpting.clay import Ellipsoid, Solid
from engine.lab.sculpting.measured import MeasuredHead
from engine.lab.sculpting.motions import FITTED
from engine.lab.sculpting.sculpture import sculpt
from engine.lab.sculpting.shapes import HINGE
from engine.take import SHAPES, Array

# Shapes in which lips that touch go on touching.
CLOSED = (
    "mouthLeft", "mouthSmileLeft", "mouthFrownLeft", "mouthDimpleLeft", "mouthStretchLeft", "mouthPressLeft",
    "mouthPucker", "cheekPuff", "cheekSquintLeft",
)  # fmt: skip
STEP_CM = 1.75  # between measured places
FARTHEST_CM, LARGEST = 1.6, 0.5  # how far a solid's place, and the logarithm of a radius, may go in one fit
PLACE_PENALTY, RADIUS_PENALTY = 0.08, 0.5  # what a centimetre, and a factor e, cost in centimetres of misfit


def fit_clay(measured: MeasuredHead) -> tuple[dict[str, tuple[Solid, ...]], float]:
    """Return the clay's solids by table, fitted to measured places, and the error in cm on places that were not used.

    Minimises ``sum distance(p)^2 + penalty |change|^2`` over places and logarithms of radii; what lies on the midline
    stays there.
    """
    tables = {name: getattr(clay, name.upper()) for name in ("head", "neck", "sockets", "nose", "philtrum")}
    places, start = measured.places(step=STEP_CM), _packed(tables)
    free = _free(tables)
    penalty = np.where(_is_place(tables), PLACE_PENALTY, RADIUS_PENALTY)[free]
    limit = np.where(_is_place(tables), FARTHEST_CM, LARGEST)[free]

    def solids(values: Array) -> dict[str, tuple[Solid, ...]]:
        every = start.copy()
        every[free] = values
        return _unpacked(every, tables)

    def misfit(values: Array) -> Array:
        return np.concatenate([clay.distance_to(places, **solids(values)), penalty * (values - start[free])])

    found = least_squares(misfit, start[free], bounds=(start[free] - limit, start[free] + limit), max_nfev=20).x
    unseen = measured.places(step=1.0, seed=5)
    return solids(found), float(np.sqrt((clay.distance_to(unseen, **solids(found)) ** 2).mean()))


def _numbers(solid: Solid) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the places and the radii of a solid."""
    if isinstance(solid, Ellipsoid):
        return solid.centre, solid.radii
    return (*solid.start, *solid.end), solid.radii


def _packed(tables: dict[str, tuple[Solid, ...]]) -> Array:
    parts = [(*_numbers(s)[0], *np.log(_numbers(s)[1])) for solids in tables.values() for s in solids]
    return np.concatenate(parts).astype(np.float64)


def _is_place(tables: dict[str, tuple[Solid, ...]]) -> Array:
    parts = [[True] * len(_numbers(s)[0]) + [False] * len(_numbers(s)[1]) for each in tables.values() for s in each]
    return np.concatenate(parts)


def _free(tables: dict[str, tuple[Solid, ...]]) -> Array:
    """Return which numbers may change: not the x of what lies on the midline."""
    parts = []
    for solid in (solid for solids in tables.values() for solid in solids):
        places, radii = _numbers(solid)
        parts.append([not (axis % 3 == 0 and value == 0.0) for axis, value in enumerate(places)] + [True] * len(radii))
    return np.concatenate(parts)


def _unpacked(values: Array, tables: dict[str, tuple[Solid, ...]]) -> dict[str, tuple[Solid, ...]]:
    at, found = 0, {}
    for name, solids in tables.items():
        moved: list[Solid] = []
        for solid in solids:
            places, radii = (len(part) for part in _numbers(solid))
            where, size = values[at : at + places].tolist(), np.exp(values[at + places : at + places + radii]).tolist()
            at += places + radii
            if isinstance(solid, Ellipsoid):
                moved.append(replace(solid, centre=tuple(where), radii=tuple(size)))
            else:
                moved.append(replace(solid, start=tuple(where[:3]), end=tuple(where[3:]), radii=tuple(size)))
        found[name] = tuple(moved)
    return found


def fit_motions(measured: MeasuredHead, path: Path = FITTED) -> None:
    """Write the motion of every shape by handles: the measured paths, made symmetric, with lips that do not pass."""
    head = sculpt()
    placed = handles.of(head)
    count = len(placed.names)
    matched = measured.matched(placed.names, head.skin[placed.vertices[:count]])
    stored = {}
    for shape in SHAPES:
        paths = None if shape.endswith("Right") else measured.paths(shape, matched)
        if paths is None:
            continue
        halves = [_joined_lips(half, placed.names, shape) for half in _symmetric(shape, paths[:count], paths[count:])]
        turn, shift = measured.jaw(shape, HINGE)
        stored[shape] = {
            "left": np.round(halves[0], 2).tolist(),
            "right": np.round(halves[1], 2).tolist(),
            "lids": measured.lids(shape),
            "jaw": [round(turn, 1), *np.round(shift, 2).tolist()],
        }
    path.write_text(json.dumps({"handles": placed.names, "shapes": stored}))


def _symmetric(shape: str, left: Array, right: Array) -> tuple[Array, Array]:
    if shape.endswith("Left"):
        return left, right
    mean = (left + right * [-1, 1, 1]) / 2
    return mean, mean * [-1, 1, 1]


def _joined_lips(moves: Array, names: Sequence[str], shape: str) -> Array:
    """Keep lips from passing each other, and from parting in the shapes of `CLOSED`; the corner moves as one."""
    at = {name: index for index, name in enumerate(names)}
    joined = moves.copy()
    for place in range(12, 24, 2):
        upper, lower = at[f"lip 8 {place}"], at[f"lip 8 {48 - place}"]
        if shape in CLOSED:
            joined[upper] = joined[lower] = (moves[upper] + moves[lower]) / 2
        elif shape != "mouthClose" and moves[lower, 1] > moves[upper, 1]:
            joined[upper, 1] = joined[lower, 1] = (moves[upper, 1] + moves[lower, 1]) / 2
    inner, outer = at["lip 8 24"], at["lip 4 24"]
    joined[inner] = joined[outer] = (moves[inner] + moves[outer]) / 2
    return joined
