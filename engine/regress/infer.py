"""Using the trained networks: a whole take, or only the window that an edit can reach."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
import torch

from engine.controls import CONTROLS
from engine.models.checkpoint import MODELS, load_model
from engine.regress import contacts
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
        self.networks = networks
        for network in networks.values():
            network.eval()

    def infer(self, controls: Array, *, full: bool = True, land: bool = True, kept: Array | None = None) -> Array:
        """Return weights, (frames, 52) float64 in 0..1, of controls, (frames, 8), or 14 with the extended ones.

        `full=False` stops at the regressor and is not clamped; `land=False` leaves out what the full system does for
        contacts. Shapes that no given control speaks of, gaze without its controls, are as in `kept`, (frames, 52), or
        zero without it: where the eyes look moves the lids too.
        """
        return self.infer_range(controls, 0, len(controls), full=full, land=land, kept=kept)

    def infer_range(
        self,
        controls: Array,
        start: int,
        stop: int,
        *,
        full: bool = True,
        land: bool = True,
        kept: Array | None = None,
    ) -> Array:
        """Return rows [start, stop) of `infer`, looking no further than the networks can feel."""
        first = max(0, (start - REACH) // ALIGNMENT * ALIGNMENT)
        last = min(len(controls), -(-(stop + REACH) // ALIGNMENT) * ALIGNMENT)
        rows = slice(start - first, stop - first)
        weights = np.zeros((last - first, len(SHAPES))) if kept is None else np.array(kept[first:last])
        trust = self._fill(weights, controls[first:last], full=full)
        if not full:
            return weights[rows]
        made = np.clip(weights[rows], 0.0, 1.0)
        return contacts.met(made, controls[start:stop], trust[rows]) if land else made

    def _fill(self, weights: Array, controls: Array, *, full: bool) -> Array:
        """Put what the networks say into weights, (frames, 52); returns how far each contact is to be trusted, (frames, 3).

        The last frame is held up to a multiple of the networks' pooling.
        """
        frames = len(controls)
        held = np.pad(controls, ((0, -frames % ALIGNMENT), (0, 0)), mode="edge")
        trust = np.zeros((frames, len(contacts.MEETING)))
        with torch.inference_mode():
            for area in self._areas(extended=controls.shape[1] > len(CONTROLS)):
                network = self.networks[area.name]
                asked = torch.from_numpy(held[:, area.control_columns].T.astype(np.float32))[None]
                if full:
                    asked, share = network.tempered(asked)
                    trust[:, contacts.of_area(area.name)] = share[0].numpy().T[:frames]
                weights[:, area.shape_columns] = network(asked, full=full)[0].numpy().T[:frames]
        return trust

    def _areas(self, *, extended: bool) -> list[Area]:
        return [area for area in AREAS + EXTENDED_AREAS * extended if area.name in self.networks]


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
