"""The demo take as a motion capture."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from engine.formats.markers.capture import Markers
from engine.spacetime.align import HeadMotion
from engine.spacetime.source import Source
from engine.take import Array


def captured(played: Source, *, turned: bool = True) -> Markers:
    """The take as a motion capture: neutral in frame 0, the head moving."""
    face = played.neutral + played.displacements
    face[0] = played.neutral
    time = np.arange(len(face))[:, None] / 30
    angles = 0.3 * np.sin(time * [1.0, 0.7, 0.4]) * turned
    head = HeadMotion(Rotation.from_euler("YXZ", angles).as_matrix(), 40 * np.sin(time * [0.5, 0.6, 0.7]) * turned)
    return Markers(head.apply(face), played.names, 30.0, "capture")


def apart(a: Array, b: Array) -> float:
    return float(np.sqrt(((a - b) ** 2).mean()))
