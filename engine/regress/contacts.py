"""Contacts: lips and lids that all but keep a small asked distance are made to keep it.

A network misses by tenths of a millimetre: nothing on an open mouth, a lost or an invented closure on a shut one.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from engine.character import bundled
from engine.controls import CONTROL_INDEX, CONTROLS, Measurer
from engine.easing import ease
from engine.exact import project
from engine.regress.areas import AREAS
from engine.take import SHAPES, Array

MEETING = tuple(CONTROL_INDEX[name] for name in ("lips_vertical", "eyelid_right", "eyelid_left"))
AREA_OF = ("lower", "eyelids", "eyelids")
SHUT_MM = 0.2  # nearer than this nothing is to be gained, and which way to move gets lost
NEAR_MM, FAR_MM = 5.5, 7.0  # asked or reached: nearer than the first is about to touch, further than the second is open
CLOSE_MM, APART_MM = 4.0, 8.0  # a face that misses by less is corrected; one that misses by more was mended on purpose
ALIKE_MM, UNLIKE_MM = 3.0, 5.0  # so was one whose lids move together where the request's do not
TEMPERED, WHOLE = 0.4, 0.7  # and one whose request had to be scaled down that much
ROUNDS, MET_MM = 3, 0.01
FREE = np.isin(np.arange(len(SHAPES)), np.concatenate([area.shape_columns for area in AREAS if area.name in AREA_OF]))


def of_area(name: str) -> npt.NDArray[np.bool_]:
    """Return which of `MEETING` an area's network is asked for."""
    return np.array([one == name for one in AREA_OF])


@lru_cache(maxsize=1)
def _measurer() -> Measurer:
    return Measurer(bundled(), [CONTROLS[column] for column in MEETING])


def _fade(value: Array, start: float, stop: float) -> Array:
    """Return 1 up to `start`, easing to 0 at `stop`."""
    return ease((stop - value) / (stop - start))


def met(weights: Array, asked: Array, scale: Array, original: Array | None = None) -> Array:
    """Return weights, (frames, 52) in 0..1, that keep the distances of asked curves, (frames, 8) in mm, each frame for itself.

    Only shapes of the mouth and the lids move. `scale`, (frames, 3), is that by which a request was tempered. What an
    `original`, (frames, 8) in mm, does itself is no mistake: only by how far a request departs from it can it be one.
    """
    wanted, measurer = asked[:, MEETING], _measurer()
    reached = measurer.measure(weights)
    missed = np.where(np.maximum(wanted, reached) > SHUT_MM, np.maximum(wanted, SHUT_MM) - reached, 0.0)
    off, unlike = np.abs(missed), np.abs(missed[:, 1] - missed[:, 2])
    if original is not None:
        departed = wanted - original[:, MEETING]
        off, unlike = np.minimum(off, np.abs(departed)), np.minimum(unlike, np.abs(departed[:, 1] - departed[:, 2]))
    share = _fade(np.minimum(wanted, reached), NEAR_MM, FAR_MM) * _fade(off, CLOSE_MM, APART_MM)
    share *= _fade(-scale, -WHOLE, -TEMPERED)
    share[:, 1:] *= _fade(unlike, ALIKE_MM, UNLIKE_MM)[:, None]
    rows = (np.abs(share * missed) > MET_MM).any(axis=1)
    landed = np.array(weights)
    if rows.any():
        target = (reached + share * missed)[rows]
        landed[rows] = project(landed[rows], target, np.arange(len(MEETING)), measurer, free=FREE, rounds=ROUNDS)
    return landed
