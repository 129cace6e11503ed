"""The last sharp pictures, so that looking at the original and back draws nothing twice."""

from __future__ import annotations

from collections import OrderedDict

from app.preview.renderer import Picture
from app.preview.worker import Wanted

KEPT = 5  # before, after, wipe, split and difference of one frame; some MB each

Key = tuple[object, ...]


class KeptPictures:
    """Remembers sharp pictures by all that they depend on."""

    def __init__(self) -> None:
        self._pictures: OrderedDict[Key, Picture] = OrderedDict()

    def put(self, wanted: Wanted, picture: Picture) -> None:
        """Keep a picture, if it is one that can be wanted again; the oldest makes room."""
        key = _key(wanted)
        if key is not None:
            self._pictures[key] = picture
            self._pictures.move_to_end(key)
            while len(self._pictures) > KEPT:
                self._pictures.popitem(last=False)

    def get(self, wanted: Wanted) -> Picture | None:
        """Return the picture of the very same, if it is kept."""
        key = _key(wanted)
        return None if key is None else self._pictures.get(key)


def _key(wanted: Wanted) -> Key | None:
    """Return all that a picture depends on; None for one that passes: coarse, live, a strip, or side by side with others."""
    shot = wanted.shot
    if not shot.smooth_edges or wanted.live or wanted.strip or wanted.sides or shot.heads:
        return None
    faces = tuple(None if face is None else face.tobytes() for face in shot.faces)
    compared = None if shot.compared_to is None else shot.compared_to.tobytes()
    return faces, compared, shot.camera, shot.size, wanted.character
