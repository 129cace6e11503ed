"""What recorded faces do: how their weights vary together, and how far and how fast each control was seen to go."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.ndimage import median_filter

from engine.anatomy import MIRROR
from engine.controls import ALL_CONTROLS
from engine.models.checkpoint import MODELS, load_model
from engine.take import SHAPES, Array

KIND = "prior"
Columns = npt.NDArray[np.int64]
# Of each control, its mirror image and the sign it takes there.
MIRROR_CONTROL: Columns = np.array(
    [
        next(
            index
            for index, other in enumerate(ALL_CONTROLS)
            if other.name == control.name.replace("left", "#").replace("right", "left").replace("#", "right")
        )
        for control in ALL_CONTROLS
    ]
)
MIRROR_SIGN: Array = np.array(
    [-1.0 if control.name in ("jaw_sideways", "gaze_horizontal") else 1.0 for control in ALL_CONTROLS]
)
_ONE_WAY = ("jawRight", "jawLeft", "mouthRight", "mouthLeft")  # directions of the whole mouth, not sides of the face
RIGHT_SHAPES, LEFT_SHAPES = (
    np.array([name.endswith(side) and name not in _ONE_WAY for name in SHAPES]) for side in ("Right", "Left")
)
ACROSS = RIGHT_SHAPES[:, None] & LEFT_SHAPES | LEFT_SHAPES[:, None] & RIGHT_SHAPES
ONE_WAY_SHAPES = np.array([name in _ONE_WAY for name in SHAPES])
MOUTH_ONLY = np.array([control.area == "lower" for control in ALL_CONTROLS])
SPIKE_S = 0.17  # a departure shorter than half of this is no motion; the median of five frames at the model rate


@dataclass(frozen=True, eq=False)
class FacePrior:
    """Statistics of the recorded training faces and their mirror images.

    Attributes
    ----------
    covariance : (52, 52) of weights, the two sides of the face made independent of each other
    surface : (52, 52) by which weights' squares are mm^2 that the skin moves, likewise
    low, high : (16,) the least and the most that each control was recorded at
    fastest : (16,) the most that a control departed from its median over `SPIKE_S`
    faces : (faces, 16) controls of recorded faces, from which joint limits are taken
    whole : (faces,) bool, which of them animate more than the mouth
    """

    covariance: Array
    surface: Array
    low: Array
    high: Array
    fastest: Array
    faces: Array
    whole: npt.NDArray[np.bool_]
    _balls: dict[tuple[tuple[int, ...], float], tuple[Array, Array, float]] = field(default_factory=dict)

    def metric(self, stiffness: float) -> Array:
        """Return the covariance, (52, 52), of weights when moving the skin costs too: ``(S^-1 + stiffness G)^-1``."""
        made = np.linalg.inv(np.linalg.inv(self.covariance) + stiffness * self.surface)
        made = np.where(ACROSS, 0.0, made)
        return np.asarray((made + made[np.ix_(MIRROR, MIRROR)]) / 2)

    def ball(self, columns: Columns, share: float) -> tuple[Array, Array, float]:
        """Return mean, (n,), whitening matrix, (n, n), and radius within which a share of recorded faces lies.

        They are of the controls `columns` alone: what no one asked of the others does not count.
        """
        key = tuple(columns.tolist()), share
        if key not in self._balls:
            chosen = self.faces[:, columns] if MOUTH_ONLY[columns].all() else self.faces[self.whole][:, columns]
            mean = chosen.mean(axis=0)
            covariance = np.atleast_2d(np.cov(chosen.T))
            covariance = covariance + 0.01 * np.diag(np.diag(covariance))  # two lids are all but one control
            whiten = np.linalg.inv(np.linalg.cholesky(covariance))
            norms = np.linalg.norm((chosen - mean) @ whiten.T, axis=1)
            self._balls[key] = mean, whiten, float(np.quantile(norms, share))
        return self._balls[key]


def despiked(curves: Array, *, fps: float) -> Array:
    """Return the running median of curves, (frames, n), over `SPIKE_S`."""
    width = 2 * round(SPIKE_S * fps / 2 - 0.5) + 1
    return np.asarray(median_filter(curves, size=(max(3, width), 1), mode="nearest"))


def load(folder: Path = MODELS) -> FacePrior:
    """Read the prior; raises `AssetError` where it is missing or damaged."""
    tensors, _ = load_model(folder / "prior.safetensors", kind=KIND)
    stored: dict[str, Array] = {name: np.asarray(tensor, np.float64) for name, tensor in tensors.items()}
    return FacePrior(
        covariance=stored["covariance"],
        surface=stored["surface"],
        low=stored["low"],
        high=stored["high"],
        fastest=stored["fastest"],
        faces=stored["faces"],
        whole=stored["whole"] > 0,
    )


@lru_cache(maxsize=1)
def bundled_prior() -> FacePrior:
    """Return the prior that ships with the program."""
    return load()
