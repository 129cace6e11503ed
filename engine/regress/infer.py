"""Using the trained networks: a whole take, or only the window that an edit can reach."""

from __future__ import annotations

from functools import lru_cache, partial
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import pad

from engine.controls import CONTROLS
from engine.models.checkpoint import MODELS, load_model, rebuilt
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

    def infer(
        self,
        controls: Array,
        *,
        full: bool = True,
        land: bool = True,
        kept: Array | None = None,
        original: Array | None = None,
    ) -> Array:
        """Return weights, (frames, 52) float64 in 0..1, of controls, (frames, 8), or 14 with the extended ones.

        `full=False` stops at the regressor and is not clamped; `land=False` leaves out what the full system does for
        contacts. Shapes that no given control speaks of, gaze without its controls, are as in `kept`, (frames, 52), or
        zero without it: where the eyes look moves the lids too. What the curves of an `original`, (frames, 8 or 14), do
        themselves is neither tempered nor taken for a mistake; without one, what people were recorded to do.
        """
        return self.infer_range(controls, 0, len(controls), full=full, land=land, kept=kept, original=original)

    def infer_range(
        self,
        controls: Array,
        start: int,
        stop: int,
        *,
        full: bool = True,
        land: bool = True,
        kept: Array | None = None,
        original: Array | None = None,
    ) -> Array:
        """Return rows [start, stop) of `infer`, looking no further than the networks can feel."""
        first = max(0, (start - REACH) // ALIGNMENT * ALIGNMENT)
        last = min(len(controls), -(-(stop + REACH) // ALIGNMENT) * ALIGNMENT)
        weights = np.zeros((stop - start, len(SHAPES))) if kept is None else np.array(kept[start:stop])
        rows = slice(start - first, stop - first)
        seen = (controls[first:last], None if original is None else original[first:last])
        trust = self._fill(weights, *seen, rows, full=full)
        if not full:
            return weights
        made = np.clip(weights, 0.0, 1.0)
        if not land:
            return made
        return contacts.met(made, controls[start:stop], trust, None if original is None else original[start:stop])

    def _fill(
        self,
        weights: Array,
        controls: Array,
        original: Array | None,
        rows: slice,
        *,
        full: bool,
    ) -> Array:
        """Put what the networks say of some rows of controls into weights, (rows, 52).

        Returns how far each contact is to be trusted, (rows, 3).
        """
        trust = np.zeros((len(weights), len(contacts.MEETING)))
        for area in self._areas(extended=controls.shape[1] > len(CONTROLS)):
            asked = controls[:, area.control_columns]
            known = None if original is None else original[:, area.control_columns]
            said, trusted = self._ask(area.name, asked, known, rows, full=full)
            weights[:, area.shape_columns] = said
            trust[:, contacts.of_area(area.name)] = trusted
        return trust

    def _ask(self, area: str, asked: Array, original: Array | None, rows: slice, *, full: bool) -> tuple[Array, Array]:
        """Return an area's weights, (rows, shapes), of its curves, (frames, controls), and the trust in its contacts."""
        network = self.networks[area]
        with torch.inference_mode():
            curves = _held(asked)
            share = torch.zeros(1, 1, len(asked))
            if full:
                curves, share = network.tempered(curves, None if original is None else _held(original))
            said = network(curves, full=full, rows=rows)[0].numpy().T
        return said, share[0, :, rows].numpy().T

    def _areas(self, *, extended: bool) -> list[Area]:
        return [area for area in AREAS + EXTENDED_AREAS * extended if area.name in self.networks]


def _held(curves: Array) -> Tensor:
    """Return curves, (frames, n), as (1, n, frames), the last frame held up to a multiple of the networks' pooling."""
    held = torch.from_numpy(curves.T.astype(np.float32))[None]
    missing = -len(curves) % ALIGNMENT
    return pad(held, (0, missing), mode="replicate") if missing else held


def load(folder: Path = MODELS) -> Regressor:
    """Read every area's networks; raises `AssetError` where one is missing or damaged."""
    networks = {}
    for area in (*AREAS, *EXTENDED_AREAS):
        path = folder / f"regress_{area.name}.safetensors"
        tensors, config = load_model(path, kind="regress")
        networks[area.name] = rebuilt(partial(from_config, config), tensors, path, kind="regress")
    return Regressor(networks)


@lru_cache(maxsize=1)
def bundled() -> Regressor:
    """Return the networks that ship with the program."""
    return load()
