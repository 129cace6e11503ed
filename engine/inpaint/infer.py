"""Inference with the filling network: gaps at the model rate in, whole motion out (BSS20)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import torch
from scipy.ndimage import gaussian_filter1d

from engine.errors import AssetError
from engine.inpaint import retrieval
from engine.inpaint.base import Base, base_of, relaxation
from engine.inpaint.closures import close_lips
from engine.inpaint.features import features_without_controls
from engine.inpaint.gap import Gap
from engine.inpaint.network import Generator, GeneratorConfig, noise_curves
from engine.inpaint.residual import gate_small_motion, unexplained_share
from engine.inpaint.statistics import Statistics, regress_controls
from engine.models.checkpoint import MODELS, load_model, rebuilt, save_model
from engine.models.threads import one_thread
from engine.take import Array


@dataclass(frozen=True)
class Tuning:
    """Settings of the inference; the range tried on validation takes in brackets."""

    # Gain of the noise over training where nothing determines the pose [1 .. 8]: variants lie two thirds farther apart, and
    # at 4 s fills move half as fast as recordings instead of two fifths, for 1-2 % of error; from 4 on lids flutter.
    noise_gain: float = 2.5
    residual_over_retrieval: float = (
        0.5  # share of the residual added to retrieved motion, which moves already [.2 .. 1]
    )
    # Softness of the clip at zero of retrieved motion, in weight [.002 .. .03]; the least that keeps it moving there, as
    # recordings do. A hard clip cost a third of NPSS.
    soft_clip: float = 0.005
    # Standard deviation in frames of the high-pass filter for the detail added under control targets [4 .. 16]. Under three
    # curves it brings the spectrum of velocities a third nearer to real for .5 % of squared error; the slow part costs 5 %.
    detail_frames: float = 6.0


TUNING = Tuning()
_STATISTICS = ("mean", "scale", "rest", "spread", "cross")


class Filler:
    """Generates motion for gaps with a trained network and the statistics of its training takes.

    Parameters
    ----------
    generator : the network
    statistics : of weights and controls, for the base motion
    """

    def __init__(self, generator: Generator, statistics: Statistics) -> None:
        self.generator, self.statistics = generator.eval(), statistics

    def fill(self, gap: Gap, *, seeds: Sequence[int] = (0,)) -> Array:
        """Return filled motion, (seeds, frames, 52) float64: generated values in 0..1, known ones as they are.

        The same seed gives the same motion.
        """
        bases = self._bases(gap, seeds)
        gain = np.stack([_noise_gain(base) for base in bases])
        samples = np.stack([noise_curves(len(gap.known), np.random.default_rng(seed)) for seed in seeds])
        features = torch.from_numpy(np.stack([base.features for base in bases]))
        noise = torch.from_numpy(np.float32(gain[..., None]) * samples)
        residuals = np.stack([gate_small_motion(residual, gap) for residual in self._residuals(features, noise)])
        residuals += self._detail(gap, bases[0], samples)
        return np.stack([self._compose(gap, base, residual) for base, residual in zip(bases, residuals, strict=True)])

    def _residuals(self, features: torch.Tensor, noise: torch.Tensor) -> Array:
        with torch.inference_mode(), one_thread():
            return np.asarray(self.generator(features, noise).numpy().astype(np.float64))

    def _detail(self, gap: Gap, base: Base, samples: Array) -> Array:
        """Return the quick motion that control targets leave unexplained, (seeds, frames, 52); zero without targets.

        The high-pass part of the residual that the network gives without the targets, times `unexplained_share`.
        """
        detail = np.zeros((len(samples), *gap.known.shape))
        controlled = np.flatnonzero(np.isfinite(gap.controls).any(axis=1))
        if not len(controlled):
            return detail
        rows = slice(controlled[0], controlled[-1] + 1)  # elsewhere its share is zero
        features = torch.from_numpy(features_without_controls(gap, base.base, self.statistics)[rows])
        noise = torch.from_numpy(np.float32(TUNING.noise_gain) * samples[:, rows])
        residuals = self._residuals(features[None].expand(len(samples), -1, -1), noise)
        detail[:, rows] = residuals - gaussian_filter1d(residuals, TUNING.detail_frames, axis=1, mode="nearest")
        return np.asarray(unexplained_share(gap, self.statistics) * detail)

    def _bases(self, gap: Gap, seeds: Sequence[int]) -> list[Base]:
        """Return the base motion of each fill: seeds differ in the stretch of the take that is retrieved."""
        ranks = [seed % retrieval.TUNING.candidates if gap.rest else 0 for seed in seeds]
        bases = {rank: base_of(gap, self.statistics, rank) for rank in sorted(set(ranks))}
        return [bases[rank] for rank in ranks]

    def _compose(self, gap: Gap, base: Base, residual: Array) -> Array:
        """Add a residual to its base, clip, relax to the mean pose, meet the control targets and close the lips."""
        share = base.blend * (1 - (1 - TUNING.residual_over_retrieval) * base.retrieved)
        weights = base.base + share * residual
        weights = np.clip(weights + base.retrieved * (_soft_clip(weights) - weights), 0.0, 1.0)
        if not base.retrieved.any():
            doubt = (1 - base.certainty)[:, None]
            weights = np.clip(weights + doubt * relaxation(gap.known, self.statistics), 0.0, 1.0)
        weights = regress_controls(weights, base.blend, gap.controls, self.statistics)
        return close_lips(np.where(np.isnan(gap.known), weights, gap.known), gap)


def _noise_gain(base: Base) -> Array:
    """Return how many times stronger than in training the noise of each frame is, (frames,)."""
    doubt = (1 - base.certainty) * (1 - base.retrieved.max(axis=1))
    return np.asarray(1 + (TUNING.noise_gain - 1) * doubt)


def _soft_clip(weights: Array) -> Array:
    """Return weights above zero that still move where they were below: ``(w + hypot(w, soft_clip)) / 2``."""
    return np.asarray((weights + np.hypot(weights, TUNING.soft_clip)) / 2)


def save_filler(path: Path, filler: Filler) -> None:
    """Write a filler, from which `load` rebuilds it."""
    tensors = dict(filler.generator.state_dict())
    for name in _STATISTICS:
        tensors[f"statistics.{name}"] = torch.tensor(getattr(filler.statistics, name))
    save_model(path, tensors, kind="inpaint", config=asdict(filler.generator.config))


def load(path: Path = MODELS / "inpaint.safetensors") -> Filler:
    """Read a filler; raises `AssetError` where it is missing or damaged."""
    tensors, config = load_model(path, kind="inpaint")
    missing = torch.zeros(0)
    statistics = Statistics(*(tensors.pop(f"statistics.{name}", missing).numpy() for name in _STATISTICS))
    generator = rebuilt(lambda: Generator(GeneratorConfig(**config)), tensors, path, kind="inpaint")
    if not all(np.size(getattr(statistics, name)) for name in _STATISTICS):
        raise AssetError(f"The model file {path.name} lacks its statistics.", "Train it: retake train inpaint.")
    return Filler(generator, statistics)


@lru_cache(maxsize=1)
def bundled() -> Filler:
    """Return the network that ships with the program."""
    return load()
