"""Using the trained network: gaps at the model rate in, whole motion out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path

import numpy as np
import torch

from engine.inpaint.closures import shut_lips
from engine.inpaint.gap import Gap, Statistics, ground, resting
from engine.inpaint.network import Generator, GeneratorConfig, noise_curves
from engine.models.checkpoint import MODELS, load_model, save_model
from engine.models.threads import one_thread
from engine.take import Array

# How much stronger than in training the noise is where nothing settles the pose: variants lie two thirds farther apart, and
# at four seconds fills move half as fast as recordings instead of two fifths, for one to two per cent of error (of
# 1 ... 8 on validation takes; from 4 on lids flutter).
LIVELINESS = 2.5
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
        under = ground(gap, self.statistics)
        doubt = (1 - under.certainty)[:, None]
        features = torch.from_numpy(under.features)[None].expand(len(seeds), -1, -1)
        drawn = [noise_curves(len(under.base), np.random.default_rng(seed)) for seed in seeds]
        noise = np.float32(1 + (LIVELINESS - 1) * doubt) * np.stack(drawn)
        with torch.inference_mode(), one_thread():
            motion = self.generator(features, torch.from_numpy(noise)).numpy().astype(np.float64)
        made = np.clip(under.base + under.rise * motion, 0.0, 1.0)
        made = np.clip(made + doubt * resting(gap.known, self.statistics), 0.0, 1.0)
        known = np.where(np.isnan(gap.known), made, gap.known)
        return np.stack([shut_lips(one, gap) for one in known])


def save_filler(path: Path, filler: Filler) -> None:
    """Write a filler so that `load` rebuilds it."""
    tensors = dict(filler.generator.state_dict())
    for name in _STATISTICS:
        tensors[f"statistics.{name}"] = torch.tensor(getattr(filler.statistics, name))
    save_model(path, tensors, kind="inpaint", config=asdict(filler.generator.config))


def load(path: Path = MODELS / "inpaint.safetensors") -> Filler:
    """Read a filler; raises `AssetError` where it is missing or damaged."""
    tensors, config = load_model(path, kind="inpaint")
    generator = Generator(GeneratorConfig(**config))
    statistics = Statistics(*(tensors.pop(f"statistics.{name}").numpy() for name in _STATISTICS))
    generator.load_state_dict(tensors)
    return Filler(generator, statistics)


@lru_cache(maxsize=1)
def bundled() -> Filler:
    """Return the network that ships with the program."""
    return load()
