"""What the baselines share: three areas' modules in one file, and a plain training loop."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor, nn

from engine.errors import AssetError
from engine.lab.evaluate.baselines import FOLDER
from engine.lab.train.regress.data import Source, Windows
from engine.models.checkpoint import load_model, save_model
from engine.regress.areas import AREAS, Area
from engine.take import SHAPES, Array

Report = Callable[[str], None]


@dataclass(frozen=True)
class Material:
    """What one area's baseline is trained and selected on: the data and the splits of our own networks.

    Attributes
    ----------
    every : whether it sees the extended controls too that our networks see where they are given
    """

    area: Area
    source: Source
    valid: Windows
    every: bool = False

    def pick(self, windows: Windows) -> tuple[Tensor, Tensor]:
        """Return the area's controls and weights, (windows, n, frames) each."""
        return windows.controls[:, columns_of(self.area, every=self.every)], windows.weights[:, self.area.shape_columns]


def columns_of(area: Area, *, every: bool) -> npt.NDArray[np.int64]:
    """Return the controls that an area's baseline sees, with or without the extended ones."""
    return area.every_column if every else area.control_columns


class Areas:
    """One module for each area, (batch, controls, frames) -> (batch, shapes, frames), as a `Baseline`."""

    def __init__(self, modules: Mapping[str, nn.Module], *, alignment: int, every: bool = False) -> None:
        self.modules, self._alignment, self._every = dict(modules), alignment, every
        for module in self.modules.values():
            module.eval()

    def infer(self, controls: Array) -> Array:
        """Return weights, (frames, 52), of controls, (frames, 8 or 16); shapes of no area are zero."""
        frames = len(controls)
        padded = np.pad(controls, ((0, -frames % self._alignment), (0, 0)), mode="edge")
        weights = np.zeros((frames, len(SHAPES)))
        with torch.inference_mode():
            for area in AREAS:
                curves = torch.from_numpy(padded[:, columns_of(area, every=self._every)].T.astype(np.float32))
                weights[:, area.shape_columns] = self.modules[area.name](curves[None])[0].numpy().T[:frames]
        return weights


def save(name: str, modules: Mapping[str, nn.Module], figures: Mapping[str, Any], folder: Path = FOLDER) -> Path:
    """Write the modules of a baseline and what was found in training them into one file; returns its path."""
    tensors = {f"{area}.{key}": value for area, part in modules.items() for key, value in part.state_dict().items()}
    path = folder / f"{name}.safetensors"
    save_model(path, tensors, kind=name, config={"figures": figures})
    return path


def restore(
    name: str, build: Callable[[Area, dict[str, Any]], nn.Module], folder: Path = FOLDER
) -> dict[str, nn.Module]:
    """Return what `save` wrote in modules that `build(area, figures)` makes.

    Raises `AssetError` that says how to train a baseline that is missing.
    """
    modules: dict[str, nn.Module] = {}
    try:
        tensors, config = load_model(folder / f"{name}.safetensors", kind=name)
        for area in AREAS:
            modules[area.name] = build(area, config["figures"][area.name])
            prefix = f"{area.name}."
            own = {key.removeprefix(prefix): value for key, value in tensors.items() if key.startswith(prefix)}
            modules[area.name].load_state_dict(own)
    except (AssetError, KeyError, RuntimeError) as error:
        raise AssetError(
            f"The baseline {name} is missing or damaged.", "Train it: retake train regress_baselines."
        ) from error
    return modules


def fit(
    module: nn.Module,
    loss: Callable[[Tensor, Tensor], Tensor],
    material: Material,
    *,
    epochs: int,
    key: int,
    score: Callable[[Tensor, Tensor], Tensor] | None = None,
    batch: int = 128,
    rate: float = 1e-3,
    patience: int = 5,
) -> float:
    """Minimise `loss(controls, weights)` with Adam, the rate x 0.95 after `patience` epochs without improvement.

    The module ends as it was in its best epoch on the validation windows by `score`; returns that score.
    """
    score = score or loss
    optimizer = torch.optim.Adam(module.parameters(), lr=rate)
    best, kept, stale = float("inf"), copy.deepcopy(module.state_dict()), 0
    for epoch in range(epochs):
        controls, weights = material.pick(material.source.epoch(key, epoch))
        order = torch.randperm(len(controls), generator=torch.Generator().manual_seed(key * 1000 + epoch))
        module.train()
        for index in torch.split(order, batch):
            optimizer.zero_grad()
            loss(controls[index], weights[index]).backward()  # type: ignore[no-untyped-call]
            optimizer.step()
        module.eval()
        with torch.inference_mode():
            value = float(score(*material.pick(material.valid)))
        stale = 0 if value < best else stale + 1
        if value < best:
            best, kept = value, copy.deepcopy(module.state_dict())
        if stale and stale % patience == 0:
            optimizer.param_groups[0]["lr"] *= 0.95
    module.load_state_dict(kept)
    return best
