"""Closures of lips and lids: the gaps of a face, and when they count as closed (SLS12 section 7.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.character import Character
from engine.easing import ease
from engine.take import SHAPES, Array


@dataclass(frozen=True)
class Gap:
    """The gap between two landmarks: at `closed_mm` and below it counts as closed, at `open_mm` and above as open."""

    name: str
    upper: str
    lower: str
    closed_mm: float
    open_mm: float


GAPS: tuple[Gap, ...] = (
    Gap("lips", "lip_inner_upper", "lip_inner_lower", 2.0, 5.0),
    Gap("lips_left", "lip_inner_upper_left", "lip_inner_lower_left", 2.0, 5.0),
    Gap("lips_right", "lip_inner_upper_right", "lip_inner_lower_right", 2.0, 5.0),
    Gap("lids_left", "lid_upper_left", "lid_lower_left", 2.0, 4.0),
    Gap("lids_right", "lid_upper_right", "lid_lower_right", 2.0, 4.0),
)


class Gaps:
    """Measures the gaps of one character: vectors from the lower to the upper landmark, linear in the weights.

    Parameters
    ----------
    character : has the landmarks of all `GAPS` or of some; gaps without landmarks are left out
    """

    def __init__(self, character: Character) -> None:
        known = [gap for gap in GAPS if gap.upper in character.landmarks and gap.lower in character.landmarks]
        self.gaps = tuple(known)
        upper, upper_deltas = character.landmark_positions([gap.upper for gap in known])
        lower, lower_deltas = character.landmark_positions([gap.lower for gap in known])
        self.rest = upper - lower  # (g, 3) mm
        self.rows = (upper_deltas - lower_deltas).reshape(len(SHAPES), -1).T  # (3 g, 52) mm per weight

    def sizes(self, weights: Array) -> Array:
        """Return the width of each gap, (frames, g) mm, of weights, (frames, 52)."""
        vectors = self.rest + (weights @ self.rows.T).reshape(len(weights), -1, 3)
        return np.asarray(np.linalg.norm(vectors, axis=2))

    def closedness(self, weights: Array) -> Array:
        """Return the degree of closure of each gap, (frames, g) in 0..1, of weights, (frames, 52)."""
        return closedness(self.sizes(weights), self.gaps)


def closedness(sizes: Array, gaps: tuple[Gap, ...] = GAPS) -> Array:
    """Return the degree of closure, (frames, g) in 0..1, of gaps of given widths, (frames, g) mm; an unknown width is open."""
    closed = np.array([gap.closed_mm for gap in gaps])
    opened = np.array([gap.open_mm for gap in gaps])
    share = np.clip((opened - np.where(np.isfinite(sizes), sizes, np.inf)) / (opened - closed), 0.0, 1.0)
    return ease(share)
