"""What the mouth aims for on each phone: targets over ARKit shapes, typical durations, and how much each phone insists.

Durations follow the means that Klatt (1976) and Crystal and House (1988) publish for read American English; targets are
our own poses on the bundled head.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.take import SHAPE_INDEX, SHAPES, Array


@dataclass(frozen=True)
class Viseme:
    """A mouth pose: `pose` weights by shape without side, `firm` how little it yields to its neighbours (0..1)."""

    name: str
    phones: tuple[str, ...]
    duration_s: float
    firm: float
    pose: dict[str, float]


VISEMES: tuple[Viseme, ...] = (
    Viseme("sil", ("SIL",), 0.25, 0.3, {}),
    Viseme(
        "pbm",
        ("P", "B", "M"),
        0.08,
        1.0,
        {"jawOpen": 0.12, "mouthClose": 0.12, "mouthPress": 0.25, "mouthRollLower": 0.15},
    ),
    Viseme(
        "fv",
        ("F", "V"),
        0.10,
        0.9,
        {"jawOpen": 0.05, "mouthRollLower": 0.55, "mouthUpperUp": 0.20, "mouthShrugLower": 0.1},
    ),
    Viseme("th", ("TH", "DH"), 0.08, 0.5, {"jawOpen": 0.13, "mouthLowerDown": 0.15, "mouthUpperUp": 0.08}),
    Viseme("td", ("T", "D", "N", "L"), 0.07, 0.4, {"jawOpen": 0.12, "mouthLowerDown": 0.20, "mouthUpperUp": 0.08}),
    Viseme(
        "sz", ("S", "Z"), 0.11, 0.6, {"jawOpen": 0.05, "mouthStretch": 0.2, "mouthLowerDown": 0.25, "mouthUpperUp": 0.1}
    ),
    Viseme("sh", ("SH", "ZH", "CH", "JH"), 0.12, 0.7, {"jawOpen": 0.08, "mouthFunnel": 0.5, "mouthPucker": 0.2}),
    Viseme("kg", ("K", "G", "NG", "HH"), 0.08, 0.2, {"jawOpen": 0.14, "mouthLowerDown": 0.12}),
    Viseme("r", ("R", "ER"), 0.09, 0.5, {"jawOpen": 0.10, "mouthFunnel": 0.3, "mouthPucker": 0.2}),
    Viseme("w", ("W",), 0.08, 0.8, {"jawOpen": 0.05, "mouthPucker": 0.75}),
    Viseme("aa", ("AA", "AH", "AY", "AW"), 0.14, 0.5, {"jawOpen": 0.45, "mouthLowerDown": 0.15}),
    Viseme(
        "ae",
        ("AE", "EH", "EY"),
        0.13,
        0.5,
        {"jawOpen": 0.32, "mouthStretch": 0.15, "mouthLowerDown": 0.2, "mouthSmile": 0.1},
    ),
    Viseme(
        "iy",
        ("IY", "IH", "Y"),
        0.10,
        0.5,
        {"jawOpen": 0.12, "mouthSmile": 0.25, "mouthStretch": 0.2, "mouthLowerDown": 0.15},
    ),
    Viseme("ao", ("AO", "OW", "OY"), 0.15, 0.6, {"jawOpen": 0.30, "mouthFunnel": 0.45, "mouthPucker": 0.15}),
    Viseme("uw", ("UW", "UH"), 0.11, 0.7, {"jawOpen": 0.10, "mouthPucker": 0.6, "mouthFunnel": 0.15}),
)
VISEME_OF: dict[str, Viseme] = {phone: viseme for viseme in VISEMES for phone in viseme.phones}


def pose_weights(pose: dict[str, float]) -> Array:
    """Return weights, (52,), of a pose whose names stand for both sides where a shape has two."""
    weights = np.zeros(len(SHAPES))
    for name, value in pose.items():
        for full in (name, f"{name}Left", f"{name}Right"):
            if full in SHAPE_INDEX:
                weights[SHAPE_INDEX[full]] = value
    return weights
