"""Using the trained network: gaps at the model rate in, whole motion out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path

import numpy as np
import torch
from scipy.ndimage import gaussian_filter1d

from engine.errors import AssetError
from engine.inpaint.closures import shut_lips
from engine.inpaint.gap import Gap, Ground, Statistics, bent, ground, left_open, resting, substantial, unsteered
from engine.inpaint.lend import LENDERS
from engine.inpaint.network import Generator, GeneratorConfig, noise_curves
from engine.models.checkpoint import MODELS, load_model, rebuilt, save_model
from engine.models.threads import one_thread
from engine.take import Array

# How much stronger than in training the noise is where nothing settles the pose: variants lie two thirds farther apart, and
# at four seconds fills move half as fast as recordings instead of two fifths, for one to two per cent of error (of
# 1 ... 8 on validation takes; from 4 on lids flutter).
LIVELINESS = 2.5
# How much of the network's motion is added over motion lent by the take, which already moves; of 0.2 ... 1 on validation takes.
OVER_LENT = 0.5
# How softly lent motion ends at nought: what is pulled below lay there all along a span, as nothing recorded does, which cost
# a third of NPSS; of 0.002 ... 0.03 on validation takes the least that mends it.
AT_REST = 0.005
# Control curves settle how a face goes on the whole and leave its quick motion open: what the network would do unsteered,
# less its part below one hertz. Under three curves on validation takes it brings the spectrum of velocities a third
# nearer to real for half a per cent of squared error; with its slow part the error grows by a twentieth (of 4 ... 16 frames).
QUICK_FRAMES = 6.0
_STATISTICS = ("mean", "scale", "rest", "spread", "cross")


class Filler:
    """A generator with the statistics of its training takes.

    Parameters
    ----------
    generator : the network
    statistics : what the ground under a fill needs
    """

    def __init__(self, generator: Generator, statistics: Statistics) -> None:
        self.generator, self.statistics = generator.eval(), statistics

    def fill(self, gap: Gap, *, seeds: Sequence[int] = (0,)) -> Array:
        """Return filled motion, (seeds, frames, 52) float64 in 0..1 wherever it is made; known values as they are.

        The same seed gives the same motion.
        """
        unders = self._grounds(gap, seeds)
        loud = np.stack([1 + (LIVELINESS - 1) * (1 - one.certainty) * (1 - one.lent.max(axis=1)) for one in unders])
        drawn = np.stack([noise_curves(len(gap.known), np.random.default_rng(seed)) for seed in seeds])
        features = torch.from_numpy(np.stack([one.features for one in unders]))
        noise = torch.from_numpy(np.float32(loud[..., None]) * drawn)
        motions = np.stack([substantial(motion, gap) for motion in self._motions(features, noise)])
        motions += self._life(gap, unders[0], drawn)
        return np.stack([self._landed(gap, under, motion) for under, motion in zip(unders, motions, strict=True)])

    def _motions(self, features: torch.Tensor, noise: torch.Tensor) -> Array:
        with torch.inference_mode(), one_thread():
            return np.asarray(self.generator(features, noise).numpy().astype(np.float64))

    def _life(self, gap: Gap, under: Ground, drawn: Array) -> Array:
        """Return quick motion that asked controls leave open, (seeds, frames, 52); nothing where none is asked."""
        motions = np.zeros((len(drawn), *gap.known.shape))
        told = np.flatnonzero(np.isfinite(gap.controls).any(axis=1))
        if not len(told):
            return motions
        rows = slice(told[0], told[-1] + 1)  # beside seams none of it is let in, so none is made there
        features = torch.from_numpy(unsteered(gap, under.base, self.statistics)[rows])
        made = self._motions(
            features[None].expand(len(drawn), -1, -1), torch.from_numpy(np.float32(LIVELINESS) * drawn[:, rows])
        )
        motions[:, rows] = made - gaussian_filter1d(made, QUICK_FRAMES, axis=1, mode="nearest")
        return np.asarray(left_open(gap, self.statistics) * motions)

    def _grounds(self, gap: Gap, seeds: Sequence[int]) -> list[Ground]:
        """Return what is under each fill: seeds differ in the stretch of the take that lends its motion."""
        ranks = [seed % LENDERS if gap.rest else 0 for seed in seeds]
        under = {rank: ground(gap, self.statistics, rank) for rank in sorted(set(ranks))}
        return [under[rank] for rank in ranks]

    def _landed(self, gap: Gap, under: Ground, motion: Array) -> Array:
        pulled = under.base + under.rise * (1 - (1 - OVER_LENT) * under.lent) * motion
        made = np.clip(pulled + under.lent * (_above_rest(pulled) - pulled), 0.0, 1.0)
        if not under.lent.any():
            doubt = (1 - under.certainty)[:, None]
            made = np.clip(made + doubt * resting(gap.known, self.statistics), 0.0, 1.0)
        made = bent(made, under.rise, gap.controls, self.statistics)
        return shut_lips(np.where(np.isnan(gap.known), made, gap.known), gap)


def _above_rest(weights: Array) -> Array:
    """Return weights that go as near to nought as they are pulled below it, but keep moving there."""
    return np.asarray((weights + np.hypot(weights, AT_REST)) / 2)


def save_filler(path: Path, filler: Filler) -> None:
    """Write a filler so that `load` rebuilds it."""
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
