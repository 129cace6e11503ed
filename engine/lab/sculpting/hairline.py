"""Where hair grows on the scalp."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from engine.lab.modelling.solids import smooth_step
from engine.take import Array

# height of the hairline in cm by degrees from the front: forehead, temple, sideburn, over the ear, nape
HAIRLINE = PchipInterpolator(
    [0, 12, 27, 40, 52, 62, 69, 76, 83, 92, 105, 113, 123, 137, 155, 180],
    [6.9, 7.0, 7.3, 6.5, 4.4, 2.6, 0.3, -0.4, 1.4, 2.15, 1.9, 0.4, -1.9, -3.8, -5.2, -5.8],
)
CAP_CENTRE = np.array([0.0, 1.5, -0.8])


def hair_share(points: Array) -> Array:
    """Return how much hair grows on points of the scalp, (n,): 0 on the face, 1 under the cap, softly between."""
    degrees = np.degrees(np.arctan2(np.abs(points[:, 0]), points[:, 2] - CAP_CENTRE[2]))
    return smooth_step(-0.7, 0.5, points[:, 1] - HAIRLINE(degrees))
