"""Reading visemes off a face: which class each frame looks most like, where no transcript and no audio tell."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from engine.controls import CONTROL_INDEX, bundled_measurer
from engine.lab.performer.visemes import VISEMES, pose_weights
from engine.speech.visemes import NAMES, class_of
from engine.take import SHAPE_INDEX, Array, runs

CLOSED_MM = 2.0
BILABIAL_S = 0.25  # lips that stay shut longer rest
_LOOKED_AT = (
    *("jawOpen", "mouthFunnel", "mouthPucker", "mouthRollLower"),
    *(f"mouth{shape}{side}" for shape in ("Stretch", "Smile", "LowerDown", "UpperUp") for side in ("Left", "Right")),
)
_COLUMNS = np.array([SHAPE_INDEX[name] for name in _LOOKED_AT])
_SIL, _MBP = NAMES.index("sil"), NAMES.index("mbp")


@lru_cache(maxsize=1)
def _poses() -> tuple[Array, np.ndarray]:
    """Return the open mouth's poses, (poses, shapes), and their classes: of each pose, that of its first phone."""
    open_mouths = [viseme for viseme in VISEMES if viseme.name not in ("sil", "pbm")]
    poses = np.array([pose_weights(viseme.pose)[_COLUMNS] for viseme in open_mouths])
    return poses, np.array([class_of(viseme.phones[0]) for viseme in open_mouths])


def read_lips(weights: Array, *, fps: float) -> np.ndarray:
    """Return the viseme class of each frame, (frames,) int, of weights, (frames, 52).

    Lips that meet for at most `BILABIAL_S` say M, B or P, longer ones rest; an open mouth is the nearest pose. A class
    of a single frame between two alike is taken for theirs.
    """
    poses, classes = _poses()
    faces = weights[:, _COLUMNS]
    away = (faces**2).sum(axis=1)[:, None] - 2 * faces @ poses.T + (poses**2).sum(axis=1)
    present = classes[np.argmin(away, axis=1)]
    lips = bundled_measurer().measure(weights)[:, CONTROL_INDEX["lips_vertical"]]
    for start, stop in runs(lips < CLOSED_MM):
        brief = stop - start <= BILABIAL_S * fps and start > 0 and stop < len(present)
        present[start:stop] = _MBP if brief else _SIL
    lone = (present[:-2] == present[2:]) & (present[1:-1] != _MBP)
    present[1:-1][lone] = present[:-2][lone]
    return np.asarray(present)
