"""Using the trained networks: a whole take, or only the window that an edit can reach."""

from __future__ import annotations

from functools import lru_cache, partial
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import pad

from engine.controls import ALL_CONTROLS, ALL_INDEX, CONTROLS
from engine.extended import bundled_face
from engine.models.checkpoint import MODELS, load_model, rebuilt
from engine.regress import contacts
from engine.regress.areas import AREAS, EXTENDED_AREAS, Area
from engine.regress.network import ALIGNMENT, REACH, AreaNetwork, from_config
from engine.take import SHAPES, Array

_LOWER, _UPPER, _EYELIDS = AREAS
_BROWS, _, _GAZE = EXTENDED_AREAS
_ORDER = [_GAZE, _UPPER, _BROWS, _EYELIDS, _LOWER]


class Regressor:
    """Controls to weights with the networks of each area.

    Parameters
    ----------
    networks : by area name, put in evaluation mode; shapes of an area without one come out as zero
    """

    def __init__(self, networks: dict[str, AreaNetwork]) -> None:
        self.networks = networks
        for network in networks.values():
            network.eval()
            if network.constraint is not None:
                network.constraint.double()  # what a solve makes of rounding shows, and is not alike in a take and a part

    def infer(
        self,
        controls: Array,
        *,
        full: bool = True,
        land: bool = True,
        kept: Array | None = None,
        original: Array | None = None,
    ) -> Array:
        """Return weights, (frames, 52) float64 in 0..1, of controls, (frames, 8), or 16 with the extended ones.

        `full=False` stops at the regressor; `land=False` leaves out what the full system does for contacts once the
        networks have brought their faces onto the controls. Shapes that no given control speaks of, gaze without its
        controls, are as in `kept`, (frames, 52), or zero without it: where the eyes look moves the lids too. What the
        curves of an `original`, (frames, 8 or 16), do themselves is neither tempered nor taken for a mistake; without one,
        what people were recorded to do.
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
        near = slice(first, last)
        held = None if kept is None else kept[near]
        known = None if original is None else _known(original[near], held)
        trust = self._fill(weights, _known(controls[near], held), known, rows, full=full)
        made = np.clip(weights, 0.0, 1.0)
        if not (full and land):
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
        """Put what the networks say of some rows of controls, (frames, 16), into weights, (rows, 52).

        Returns how far each contact is to be trusted, (rows, 3).
        """
        trust = np.zeros((len(weights), len(contacts.MEETING)))
        for area in self._areas(controls):
            network, given = self.networks[area.name], len(area.controls)
            with torch.inference_mode():
                curves, share = _held(controls[:, area.every_column]), torch.zeros(1, 1, len(controls))
                known = None if original is None else _held(original[:, area.every_column])
                if full:
                    tempered, share = network.tempered(curves[:, :given], None if known is None else known[:, :given])
                    curves = torch.cat([tempered, curves[:, given:]], dim=1)
                made = network(curves, full=full, rows=rows, original=known)
                still = torch.from_numpy(weights.T.astype(np.float32))[None]
                near = None if known is None else known[..., rows]
                made = network.constrained(made, curves[..., rows], still, full=full, original=near)
            weights[:, area.shape_columns] = made[0].numpy().T
            trust[:, contacts.of_area(area.name)] = share[0, :, rows].numpy().T
        return trust

    def _areas(self, controls: Array) -> list[Area]:
        """Return the areas in the order in which each is brought onto its controls: the upper lip hangs on the nose."""
        known = [area for area in (_GAZE, _BROWS) if not np.isnan(controls[:, area.control_columns]).any()]
        order = sorted((*AREAS, *known), key=_ORDER.index)
        return [area for area in order if area.name in self.networks]


def _known(controls: Array, kept: Array | None) -> Array:
    """Return all control curves, (frames, 16), NaN where nothing is known: where the eyes look is, of what is kept."""
    curves = np.full((len(controls), len(ALL_CONTROLS)), np.nan)
    curves[:, : controls.shape[1]] = controls
    if kept is not None and controls.shape[1] == len(CONTROLS):
        curves[:, ALL_INDEX["gaze_vertical"]] = bundled_face().measure(kept)[:, ALL_INDEX["gaze_vertical"]]
    return curves


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
