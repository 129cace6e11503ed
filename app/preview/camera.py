"""An orbiting camera, as plain numbers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from engine.take import Array

FACE_WIDTH = 0.84  # of the head's: where there is little room the ears go, and the face is shown larger
FIELD_OF_VIEW_DEG = 18.0  # a portrait lens: wider ones enlarge the nose


@dataclass(frozen=True)
class Camera:
    """Where the head is looked at from.

    Attributes
    ----------
    around_deg, above_deg : orbit; 0, 0 is straight ahead, positive goes to the head's left and up
    zoom : 1 shows the whole head, in a narrow picture the face
    pan : shift of the point looked at, in parts of the head's height, right and up on screen
    """

    around_deg: float = 0.0
    above_deg: float = 4.0
    zoom: float = 1.0
    pan: tuple[float, float] = (0.0, 0.0)

    def orbited(self, *, around_deg: float, above_deg: float) -> Camera:
        """Return the camera moved around the head, kept from tipping over the top."""
        above = float(np.clip(self.above_deg + above_deg, -85.0, 85.0))
        return replace(self, around_deg=(self.around_deg + around_deg + 180.0) % 360.0 - 180.0, above_deg=above)

    def zoomed(self, factor: float) -> Camera:
        """Return the camera nearer by a factor."""
        return replace(self, zoom=float(np.clip(self.zoom * factor, 0.5, 8.0)))

    def panned(self, right: float, up: float) -> Camera:
        """Return the camera shifted, in parts of the head's height."""
        limit = 1.0
        x, y = np.clip((self.pan[0] + right, self.pan[1] + up), -limit, limit)
        return replace(self, pan=(float(x), float(y)))

    def pose(self, low: Array, high: Array, *, aspect: float) -> Array:
        """Return the (4, 4) camera pose that frames the box low..high, (3,) each, for a width / height."""
        size = high - low
        around, above = np.radians(self.around_deg), np.radians(self.above_deg)
        ahead = np.array([np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)])
        right = np.cross([0.0, 1.0, 0.0], ahead)
        right /= np.linalg.norm(right)
        up = np.cross(ahead, right)
        wide = abs(right[0]) * FACE_WIDTH * size[0] + abs(right[2]) * size[2]
        shown = 1.06 * max(size[1], wide / aspect) / self.zoom
        target = (low + high) / 2 + size[1] * (self.pan[0] * right + self.pan[1] * up)
        pose = np.eye(4)
        pose[:3, :3] = np.stack([right, up, ahead], axis=1)
        pose[:3, 3] = target + ahead * (shown / 2 / np.tan(np.radians(FIELD_OF_VIEW_DEG / 2)) + size[2] / 4)
        return pose


PRESETS: dict[str, Camera] = {
    "Front": Camera(),
    "Three-quarter": Camera(around_deg=35.0, above_deg=6.0),
    "Side": Camera(around_deg=90.0, above_deg=2.0),
    "Mouth": Camera(above_deg=2.0, zoom=3.2, pan=(0.0, -0.13)),
    "Eyes": Camera(above_deg=2.0, zoom=2.8, pan=(0.0, 0.13)),
}
