"""The Mahalanobis distance of a mouth from the recorded ones, and the share of them that is nearer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine.assets import MODELS
from engine.controls import ALL_CONTROLS
from engine.errors import AssetError
from engine.take import Array

MOUTH: npt.NDArray[np.int64] = np.array([i for i, control in enumerate(ALL_CONTROLS) if control.area == "lower"])
RIDGE = 0.01  # of the variances, which is added to them, as where joint limits of a drag are taken from the same faces
DIGITS = 6  # of a distance that count, so that it is the same whether curves were measured whole or in parts


@dataclass(frozen=True, eq=False)
class Recorded:
    """The recorded mouths that others are compared with.

    Attributes
    ----------
    mean : (9,) of the mouth's controls
    whiten : (9, 9), the inverse of the Cholesky factor of their covariance
    distances : (faces,) of the recorded mouths themselves, ascending
    """

    mean: Array
    whiten: Array
    distances: Array

    @property
    def furthest(self) -> float:
        """The distance of the recorded mouth that is furthest from the mean one."""
        return float(self.distances[-1])

    def distance(self, controls: Array) -> Array:
        """Return the Mahalanobis distance ``|W (c - mean)|``, (frames,), of controls, (frames, all controls)."""
        away = np.einsum("fc,dc->fd", controls[:, MOUTH] - self.mean, self.whiten)
        return np.asarray(np.round(np.sqrt(np.einsum("fd,fd->f", away, away)), DIGITS))

    def nearer(self, distance: float) -> float:
        """Return the share of recorded mouths that are nearer to the mean one."""
        return float(np.searchsorted(self.distances, distance) / len(self.distances))


def recorded_of(faces: Array) -> Recorded:
    """Return the recorded mouths, from the controls of recorded faces, (faces, all controls)."""
    mouths = faces[:, MOUTH]
    covariance = np.cov(mouths.T)
    whiten = np.linalg.inv(np.linalg.cholesky(covariance + RIDGE * np.diag(np.diag(covariance))))
    found = Recorded(mouths.mean(axis=0), np.ascontiguousarray(whiten), np.zeros(0))
    return Recorded(found.mean, found.whiten, np.sort(found.distance(faces)))


@lru_cache(maxsize=1)
def recorded(folder: Path = MODELS) -> Recorded:
    """Return the faces that the bundled prior was learned from; raises `AssetError` where it is missing or damaged."""
    from safetensors import SafetensorError, safe_open

    try:  # by numpy: torch takes seconds to load, and the window should be seen first
        with safe_open(str(folder / "prior.safetensors"), framework="numpy") as file:
            return recorded_of(np.asarray(file.get_tensor("faces"), np.float64))
    except (OSError, SafetensorError, ValueError, np.linalg.LinAlgError, IndexError) as error:
        raise AssetError(
            "The model file prior.safetensors is missing or damaged.", "Train it: retake train prior."
        ) from error
