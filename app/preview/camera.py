"""An orbiting camera, as plain numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from engine.take import Array

FACE_WIDTH = 0.84  # of the head's: where there is little room the ears go, and the face is shown larger
FIELD_OF_VIEW_DEG = 18.0  # a portrait lens: wider ones enlarge the nose


@dataclass(frozen=True)
class Camera:
    """The camera that the head is seen from.

    Attributes
    ----------
    around_deg, above_deg : orbit; 0, 0 is straight ahead, positive goes to the head's left and up
    zoom : 1 shows the whole head, in a narrow picture the face; or `frame`
    pan : shift of the point looked at, in parts of the head's height, right and up on screen
    frame : width and height of what is in the picture whatever its format, in parts of the head's height; None: the head
    """

    around_deg: float = 0.0
    above_deg: float = 4.0
    zoom: float = 1.0
    pan: tuple[float, float] = (0.0, 0.0)
    frame: tuple[float, float] | None = None

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

    def aimed(self, at: Array, low: Array, high: Array) -> Camera:
        """Return the camera with a point, (3,), in the middle of the picture, for the head that fills the box low..high."""
        right, up, _ = self._axes()
        away = (at - (low + high) / 2) / (high - low)[1]
        return replace(self, pan=(float(away @ right), float(away @ up)))

    def _axes(self) -> tuple[Array, Array, Array]:
        """Return right, up and towards the camera, (3,) each."""
        around, above = np.radians(self.around_deg), np.radians(self.above_deg)
        ahead = np.array([np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)])
        right = np.cross([0.0, 1.0, 0.0], ahead)
        right /= np.linalg.norm(right)
        return right, np.cross(ahead, right), ahead

    def shown(self, low: Array, high: Array, *, aspect: float) -> float:
        """Return the height in mm that the picture shows of the plane through the middle of the box low..high."""
        size = high - low
        if self.frame is not None:
            return float(size[1] * max(self.frame[1], self.frame[0] / aspect) / self.zoom)
        right, _, _ = self._axes()
        wide = abs(right[0]) * FACE_WIDTH * size[0] + abs(right[2]) * size[2]
        return float(1.06 * max(size[1], wide / aspect) / self.zoom)

    def pose(self, low: Array, high: Array, *, aspect: float) -> Array:
        """Return the (4, 4) camera pose that frames the box low..high, (3,) each, for a width / height."""
        size = high - low
        right, up, ahead = self._axes()
        shown = self.shown(low, high, aspect=aspect)
        target = (low + high) / 2 + size[1] * (self.pan[0] * right + self.pan[1] * up)
        pose = np.eye(4)
        pose[:3, :3] = np.stack([right, up, ahead], axis=1)
        pose[:3, 3] = target + ahead * (shown / 2 / np.tan(np.radians(FIELD_OF_VIEW_DEG / 2)) + size[2] / 4)
        return pose


PRESETS: dict[str, Camera] = {
    "Front": Camera(),
    "Three-quarter": Camera(around_deg=35.0, above_deg=6.0),
    "Side": Camera(around_deg=90.0, above_deg=2.0),
    # as on the bundled head: where a head has landmarks, `closeup` looks where they are
    "Mouth": Camera(above_deg=2.0, pan=(0.0, -0.225), frame=(0.33, 0.3)),
    "Eyes": Camera(above_deg=2.0, pan=(0.0, 0.025), frame=(0.46, 0.2)),
}


@dataclass(frozen=True)
class _Closeup:
    """What a close view shows: between two points of a head, in parts of how far they are apart.

    Attributes
    ----------
    left, right : landmarks on either side; the middle between them is in the middle of the picture
    width, height : of what is shown
    below : how far the middle of the picture lies under theirs
    """

    left: tuple[str, ...]
    right: tuple[str, ...]
    width: float
    height: float
    below: float = 0.0


_CLOSEUPS = {
    # room for a jaw that drops
    "Mouth": _Closeup(("mouth_left",), ("mouth_right",), width=1.8, height=1.7, below=0.15),
    # between the middles of both eyes
    "Eyes": _Closeup(
        ("lid_upper_left", "lid_lower_left"), ("lid_upper_right", "lid_lower_right"), width=1.8, height=0.8
    ),
}


def looking(name: str, landmarks: Mapping[str, Array], low: Array, high: Array) -> Camera:
    """Return a preset for a head with these landmarks, (3,) each, that fills the box low..high."""
    closeup = _CLOSEUPS.get(name)
    if closeup is None or not all(point in landmarks for point in (*closeup.left, *closeup.right)):
        return PRESETS[name]
    left, right = (np.mean([landmarks[point] for point in points], axis=0) for points in (closeup.left, closeup.right))
    apart = float(np.linalg.norm(left - right))
    if not apart > 0.0:
        return PRESETS[name]
    at = (left + right) / 2 - np.array([0.0, closeup.below * apart, 0.0])
    size = apart / (high - low)[1]
    frame = float(closeup.width * size), float(closeup.height * size)
    return replace(PRESETS[name], frame=frame).aimed(at, low, high)
