"""What of a character is looked at: the box about its head, and whether anything would be seen of it."""

from __future__ import annotations

import numpy as np

from engine.character import Character
from engine.take import Array

BELOW_CHIN = 0.2  # parts of the way from chin to crown that are framed under the chin
LIDS = ("lid_upper_left", "lid_upper_right")
# Distances of the eyes, about their middle, beyond which nothing belongs to a head: a hat's brim, hands, a tail of hair.
ASIDE, ABOVE, BEHIND, AHEAD = 2.4, 3.2, 4.5, 2.0
CHIN = (0.5, 4.0)  # the same, of a chin below the eyes
FEW = 0.005  # of a mesh's extent: lids nearer to each other than that are none
SEEN_MM = (20.0, 1800.0)  # height of a box that the camera shows, between its near and its far plane
LEAST_SHARE = 0.1  # of the picture's height


def framed(character: Character) -> tuple[Array, Array]:
    """Return the lowest and highest corner, (3,) mm each, of the box to frame: from a little under the chin to the crown.

    All of a character without landmarks.
    """
    points = character.neutral.astype(np.float64)
    places = {name: points[vertex] for name, vertex in character.landmarks.items()}
    head, chin_fits = points, "chin" in places
    if set(LIDS) <= set(places):
        middle = (places[LIDS[0]] + places[LIDS[1]]) / 2
        apart = max(float(np.linalg.norm(places[LIDS[0]] - places[LIDS[1]])), 1e-9)
        away = (points - middle) / apart
        inside = (np.abs(away[:, 0]) <= ASIDE) & (away[:, 1] <= ABOVE) & (away[:, 2] >= -BEHIND) & (away[:, 2] <= AHEAD)
        if apart > FEW * float(np.ptp(points, axis=0).max()):  # a mesh of few vertices may have all landmarks at one
            head = points[inside]
        chin_fits = chin_fits and CHIN[0] <= -away[character.landmarks["chin"], 1] <= CHIN[1]
    if chin_fits:
        chin, crown = float(places["chin"][1]), float(head[:, 1].max())
        above = head[head[:, 1] >= chin - BELOW_CHIN * (crown - chin)]  # shoulders would make the face small
        head = above if len(above) else head
    return head.min(axis=0), head.max(axis=0)


def share_seen(character: Character) -> float:
    """Return how much of the picture's height the moving face takes when the character is framed, 0 to 1.

    None of it where the camera stands too near or too far to show it, or the face lies outside the picture. A character
    that no shape moves is all face.
    """
    low, high = framed(character)
    height = float(high[1] - low[1])
    if not SEEN_MM[0] <= height <= SEEN_MM[1]:
        return 0.0
    moving = np.zeros(len(character.neutral), bool)
    for delta in character.deltas:
        moving |= delta.any(axis=1)
    face = character.neutral[moving if moving.any() else slice(None)]
    bottom, top = (float(np.clip(edge, low[1], high[1])) for edge in (face[:, 1].min(), face[:, 1].max()))
    return (top - bottom) / height
