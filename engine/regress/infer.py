"""Using the trained networks: a whole take, or only the window that an edit can reach."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
import torch

from engine.controls import CONTROLS
from engine.models.checkpoint import MODELS, load_model
from engine.regress.areas import AREAS, EXTENDED_AREAS, Area
from engine.regress.network import ALIGNMENT, REACH, AreaNetwork, from_config
from engine.take import SHAPES, Array


class Regressor:
    """Controls to weights with the networks of each area; those of the extended controls run only where these are given.

    Parameters
    ----------
    networks : by area name, put in evaluation mode; shapes of an area without one come out as zero
    """

    def __init__(self, networks: dict[str, AreaNetwork]) -> None:
        self._networks = networks
        for network in networks.values():
            network.eval()

    def infer(self, controls: Array, *, full: bool = True) -> Array:
        """Return weights, (frames, 52) float64 and not clamped, of controls, (frames, 8), or 14 with the extended ones.

        The last frame is held up to a multiple of the networks' pooling; `full=False` leaves the autoencoder out. Shapes
        that no given control speaks of, gaze without its controls, are zero.
        """
        frames = len(controls)
        held = np.pad(controls, ((0, -frames % ALIGNMENT), (0, 0)), mode="edge")
        weights = np.zeros((frames, len(SHAPES)))
        with torch.inference_mode():
            for area in self._areas(extended=controls.shape[1] > len(CONTROLS)):
                columns = torch.from_numpy(held[:, area.control_columns].T.astype(np.float32))
                made = self._networks[area.name](columns[None], full=full)[0]
                weights[:, area.shape_columns] = made.numpy().T[:frames]
        return weights

    def _areas(self, *, extended: bool) -> list[Area]:
        return [area for area in AREAS + EXTENDED_AREAS * extended if area.name in self._networks]

    def infer_range(self, controls: Array, start: int, stop: int, *, full: bool = True) -> Array:
        """Return rows [start, stop) of `infer(controls)`, looking no further than the networks can feel."""
        first = max(0, (start - REACH) // ALIGNMENT * ALIGNMENT)
        last = min(len(controls), -(-(stop + REACH) // ALIGNMENT) * ALIGNMENT)
        return self.infer(controls[first:last], full=full)[start - first : stop - first]


def load(folder: Path = MODELS) -> Regressor:
    """Read every area's networks; raises `AssetError` where one is missing or damaged."""
    networks = {}
    for area in (*AREAS, *EXTENDED_AREAS):
        tensors, config = load_model(folder / f"regress_{area.name}.safetensors", kind="regress")
        network = from_config(config)
        network.load_state_dict(tensors)
        networks[area.name] = network
    return Regressor(networks)


@lru_cache(maxsize=1)
def bundled() -> Regressor:
    """Return the networks that ship with the program."""
    return load()
