"""What the networks make of an edit: N(edited curves) - N(original curves), alike on both sides of the face."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import torch

from engine.anatomy import MIRROR
from engine.controls import ALL_CONTROLS
from engine.regress.areas import AREAS, EXTENDED_AREAS, Area
from engine.regress.infer import Regressor
from engine.regress.network import ALIGNMENT
from engine.regress.prior import LEFT_SHAPES, MIRROR_CONTROL, MIRROR_SIGN, ONE_WAY_SHAPES, RIGHT_SHAPES
from engine.take import SHAPES, Array

AROUND = 16  # frames by which the curves at both ends are held, so that no network sees the zeros beyond [8..32]
_RIGHT, _LEFT = (
    np.array([i for i, control in enumerate(ALL_CONTROLS) if control.name.endswith(side)]) for side in ("right", "left")
)
_SIGNED = ("jaw", "gaze")  # networks of a control that changes its sign in a mirror


@dataclass
class Proposer:
    """Runs the networks over the frames of an edit alone, at the model rate.

    An edit is seen apart from what lies around it: the curves at its ends are held. So it comes out the same wherever
    it lies in a take, and whatever is edited elsewhere. Mirrored, it comes out mirrored: one network sees the curves of
    each side of the face as if both sides were alike, and the mean of both its sides is taken.

    Attributes
    ----------
    regressor : the networks
    """

    regressor: Regressor
    _known: dict[str, tuple[Array, int, Array]] = field(default_factory=dict)

    def change(self, original: Array, edited: Array, areas: tuple[str, ...], *, origin: int = 0) -> Array:
        """Return the change of weights, (frames, 52), from original to edited curves, (frames, 16), at the model rate.

        Of the networks of these areas; `origin` is the frame from which they count when they pool frames.
        """
        change = np.zeros((len(original), len(SHAPES)))
        for area in AREAS + EXTENDED_AREAS:
            if area.name in areas and area.name in self.regressor.networks:
                made = self._of(area, edited, origin) - self._remembered(area, original, origin)
                change += np.where(ONE_WAY_SHAPES, 0.0, made) if area.name == "lower" else made
        return change

    def _remembered(self, area: Area, curves: Array, origin: int) -> Array:
        """Return what a network says of the original curves, which stay the same while an edit is dragged."""
        known = self._known.get(area.name)
        if known is None or known[1] != origin or not np.array_equal(known[0], curves):
            known = self._known[area.name] = curves, origin, self._of(area, curves, origin)
        return known[2]

    def _of(self, area: Area, curves: Array, origin: int) -> Array:
        """Return the weights, (frames, 52), that an area's network makes of curves, (frames, 16)."""
        signed = area.name in _SIGNED
        pair = (curves, _mirrored(curves)) if signed else (_alike(curves, _RIGHT), _alike(curves, _LEFT))
        one, other = self._run(area, np.stack([each[:, area.control_columns] for each in pair]), origin)
        if signed:
            return np.asarray((one + other[:, MIRROR]) / 2)
        right, left = ((each + each[:, MIRROR]) / 2 for each in (one, other))
        return np.asarray(np.where(RIGHT_SHAPES, right, np.where(LEFT_SHAPES, left, (right + left) / 2)))

    def _run(self, area: Area, curves: Array, origin: int) -> Array:
        """Return weights, (2, frames, 52), of curves, (2, frames, controls)."""
        frames = curves.shape[1]
        before = AROUND + -(AROUND + origin) % ALIGNMENT
        after = AROUND + -(before + frames + AROUND) % ALIGNMENT
        held = np.pad(curves, ((0, 0), (before, after), (0, 0)), mode="edge").transpose(0, 2, 1)
        weights = np.zeros((2, frames, len(SHAPES)))
        with torch.inference_mode():
            made = self.regressor.networks[area.name](torch.from_numpy(held.astype(np.float32)))
        weights[:, :, area.shape_columns] = made[:, :, before : before + frames].numpy().transpose(0, 2, 1)
        return np.clip(weights, 0.0, 1.0)


def _alike(curves: Array, columns: Array) -> Array:
    """Return curves, (frames, 16), whose sides are both as the one that has these columns."""
    alike = curves.copy()
    alike[:, _RIGHT] = alike[:, _LEFT] = curves[:, columns]
    return alike


def _mirrored(curves: Array) -> Array:
    return np.asarray(MIRROR_SIGN * curves[:, MIRROR_CONTROL])
