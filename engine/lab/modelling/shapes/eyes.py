"""Shapes of the left lids and eyeball."""

from __future__ import annotations

from engine.lab.modelling import eyelids, hair
from engine.lab.modelling.clay import EYE_CENTRE
from engine.lab.modelling.sculpture import Sculpture
from engine.lab.modelling.shapes.fields import Stroke, strokes
from engine.lab.modelling.solids import turn_x, turn_y
from engine.take import Array


def move_lids(head: Sculpture, closed: float = 0.0, raise_upper: float = 0.0, raise_lower: float = 0.0) -> Array:
    """Turn the left lids about the eyeball; the rings towards the socket follow less and less.

    `closed` is 0..1, the raises are degrees.
    """
    motion, loops = head.still(), head.topology.eyes["left"]
    turned = eyelids.rings(closed, raise_upper, raise_lower) - eyelids.rings()
    for ring, offset in enumerate(turned, start=eyelids.SKIN_RINGS):
        motion[loops[ring]] = offset
    for ring, share in ((3, 0.55), (2, 0.25), (1, 0.08)):
        motion[loops[ring]] = share * turned[0]
    pose = (closed, raise_upper, raise_lower)
    motion[head.at["lashes_left"]] = hair.lash_points(*pose) - hair.lash_points()
    return motion


def eye_blink(head: Sculpture) -> Array:
    """Close the lids."""
    return move_lids(head, closed=1.0)


def eye_wide(head: Sculpture) -> Array:
    """Open the lids beyond rest."""
    return move_lids(head, raise_upper=6.5, raise_lower=-1.5)


def eye_squint(head: Sculpture) -> Array:
    """Narrow the eye, mostly from below."""
    below = strokes(head, Stroke((3.4, -1.6), (1.5, 0.8), (0, 0.18, 0.10)))
    return move_lids(head, raise_upper=-5.0, raise_lower=9.0) + below


def eye_look_up(head: Sculpture) -> Array:
    """Turn the eye up; the lids go with it."""
    return _gaze(head, turn_x(-24)) + move_lids(head, raise_upper=7.5, raise_lower=2.0)


def eye_look_down(head: Sculpture) -> Array:
    """Turn the eye down; the lids go with it."""
    return _gaze(head, turn_x(24)) + move_lids(head, raise_upper=-13.0, raise_lower=-4.5)


def eye_look_in(head: Sculpture) -> Array:
    """Turn the eye to the nose."""
    return _gaze(head, turn_y(-28))


def eye_look_out(head: Sculpture) -> Array:
    """Turn the eye away from the nose."""
    return _gaze(head, turn_y(28))


def _gaze(head: Sculpture, turn: Array) -> Array:
    motion, part = head.still(), head.at["eye_left"]
    local = head.points[part] - EYE_CENTRE
    motion[part] = local @ turn.T - local
    return motion
