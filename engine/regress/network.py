"""The two networks of BSBS19 figure 5: a resolution-preserving U-Net, used as regressor and as autoencoder."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn.functional import avg_pool1d, max_pool1d, pad

from engine.regress.areas import Area
from engine.regress.constraint import Constraint
from engine.regress.unet import UNet, UNetConfig

LOOK = 24  # frames on either side that are scaled with an excess, and over which the scale comes and goes
UNET_REACH = 24  # frames: one feels 2 + 2 * 2 + 4 * 2 + 2 * 2 + 2 through its convolutions and up to 3 through pooling
REACH = 2 * UNET_REACH + 2 * LOOK + 4  # two U-Nets on what looks 2 * LOOK around, and 4 for median and velocity
ALIGNMENT = 4  # frames; two poolings by two, so windows must begin on multiples of this to equal the whole take
BEYOND = 0.005  # share of recorded frames that the full system holds to be further out than a face goes
ROOM = 0.3  # of the usual bound, by which an edit may go further than the take, wherever that is


class AreaNetwork(nn.Module):
    """Autoencoder on regressor for one area: controls in mm -> weights; `full=False` stops at the regressor.

    The full system takes a control no further than the recorded faces went (`low`, `high`), and hands weights
    in 0..1 to the autoencoder: what nobody's face can do is bounded before it is judged. In use, controls are
    `tempered` first; in training they are not, so that the autoencoder learns to mend more than it will meet.

    Parameters
    ----------
    held : controls that the weights are brought onto, by name, and their places among the inputs
    shapes : columns of the weights that the network makes; needed where controls are held
    """

    low: Tensor
    high: Tensor
    centre: Tensor
    whiten: Tensor
    bound: Tensor
    usual: Tensor

    def __init__(
        self,
        regressor: UNetConfig,
        autoencoder: UNetConfig,
        *,
        held: Mapping[str, int] | None = None,
        shapes: Sequence[int] = (),
    ) -> None:
        super().__init__()
        self.regressor, self.autoencoder = UNet(regressor), UNet(autoencoder)
        self._held, self._shapes = dict(held or {}), list(shapes)
        self.constraint = Constraint(list(self._held), self._shapes) if self._held else None
        every = regressor.inputs + regressor.further
        self.register_buffer("low", torch.full((1, every, 1), -torch.inf))
        self.register_buffer("high", torch.full((1, every, 1), torch.inf))
        self.register_buffer("centre", torch.zeros(1, regressor.inputs, 1))
        self.register_buffer("whiten", torch.eye(2 * regressor.inputs))
        self.register_buffer("bound", torch.tensor(torch.inf))
        self.register_buffer("usual", torch.tensor(torch.inf))

    def forward(
        self, controls: Tensor, *, full: bool = True, rows: slice | None = None, original: Tensor | None = None
    ) -> Tensor:
        """Return weights, (batch, shapes, frames), of controls, (batch, controls, frames) in mm.

        Of some `rows` alone where they are given; neither network then runs over more than these can feel. They are not
        yet `constrained`. What the curves of an `original` take did themselves, like `controls`, is not out of bounds.
        """
        frames = controls.shape[-1]
        rows = rows or slice(0, frames)
        near = _around(rows, UNET_REACH, frames)
        if not full:
            weights: Tensor = self.regressor(controls[..., near])
            return weights[..., _within(near, rows)]
        far = _around(near, UNET_REACH, frames)
        bounded = self._bounded(controls[..., far], None if original is None else original[..., far])
        cleaned: Tensor = self.autoencoder(self.regressor(bounded)[..., _within(far, near)].clamp(0.0, 1.0))
        return cleaned[..., _within(near, rows)]

    def constrained(
        self,
        weights: Tensor,
        controls: Tensor,
        still: Tensor | None = None,
        *,
        full: bool = True,
        original: Tensor | None = None,
    ) -> Tensor:
        """Return weights, (batch, shapes, frames), brought onto the controls, (batch, controls, frames), that area holds.

        `still`, (batch, 52, frames), is the face whose other shapes stay as they are, zero without it. The full system
        holds a control no further out than the recorded faces or the `original` went, and the less, the more the weights
        miss it.
        """
        if self.constraint is None:
            return weights
        asked = self._bounded(controls, original) if full else controls
        missing = self.low.shape[1] - controls.shape[1]
        asked = pad(asked, (0, 0, 0, missing), value=torch.nan)[:, list(self._held.values())]
        exact = self.constraint.covariance.dtype
        still = None if still is None else still.to(exact)
        made: Tensor = self.constraint(weights.to(exact), asked.to(exact), still, doubting=full)
        return made.to(weights.dtype)

    def _bounded(self, controls: Tensor, original: Tensor | None) -> Tensor:
        low, high = (bound[:, : controls.shape[1]] for bound in (self.low, self.high))
        if original is not None:
            low, high = torch.fmin(low, original), torch.fmax(high, original)
        return torch.minimum(torch.maximum(controls, low), high)

    def tempered(self, controls: Tensor, original: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Return controls, (batch, controls, frames) in mm, drawn back to where faces go from where they outdo these.

        Further out or faster than `bound`, in the metric of how recorded controls and their velocities vary together,
        they are drawn back towards the mean. Of an edit, the `original` take's curves are known: it may last as far out
        as `usual`, and by `ROOM` further than the take is there, and is drawn back towards the take, which itself is
        never tempered. The departure around an excess is scaled as a whole and keeps its form; an excess too short to
        be motion, salt or pepper, is scaled alone. Returned with the scale, (batch, 1, frames), 1 where nothing had to
        be done.
        """
        known, count = self.centre.expand_as(controls) if original is None else original, controls.shape[1]
        away = controls - known
        moving = self.whiten @ _with_velocity(torch.cat([_median(away), away, known - self.centre]))
        lasting, moment, begun = moving.view(3, len(away), *moving.shape[1:])  # each (batch, 2 * controls, frames)
        # The first rows of the triangular `whiten` are of positions alone.
        rows, bound = (2 * count, self.bound) if original is None else (count, self.usual)
        share = _share(lasting[:, :rows], begun[:, :rows], bound)
        share = -max_pool1d(-share, 2 * LOOK + 1, stride=1, padding=LOOK)
        share = avg_pool1d(pad(share, (LOOK, LOOK), mode="replicate"), 2 * LOOK + 1, stride=1)
        share = torch.minimum(share, _share(moment, begun, self.bound))
        return known + away * share, share

    @torch.no_grad()
    def learn_bounds(self, controls: Tensor, unusual: float) -> None:
        """Take the bounds from recorded controls, (windows, controls, frames) in mm, a share of them `unusual`.

        Further controls are bounded each for itself.
        """
        self.low.copy_(controls.amin(dim=(0, 2))[None, :, None])
        self.high.copy_(controls.amax(dim=(0, 2))[None, :, None])
        controls = controls[:, : self.centre.shape[1]]
        self.centre.copy_(controls.mean(dim=(0, 2))[None, :, None])
        moving = _with_velocity(controls - self.centre).double().permute(0, 2, 1).flatten(0, 1)
        covariance = moving.T @ moving / len(moving)
        covariance += 0.01 * covariance.diagonal().diag()  # two lids are all but one control
        whiten = torch.linalg.inv(torch.linalg.cholesky(covariance))
        self.whiten.copy_(whiten)
        white = moving @ whiten.T
        for bound, rows, share in ((self.bound, white, BEYOND), (self.usual, white[:, : controls.shape[1]], unusual)):
            bound.copy_(rows.norm(dim=1).kthvalue(math.ceil((1 - share) * len(rows))).values)

    def config(self) -> dict[str, Any]:
        """Return what rebuilds this module."""
        parts = {"regressor": asdict(self.regressor.config), "autoencoder": asdict(self.autoencoder.config)}
        return parts | {"held": self._held, "shapes": self._shapes}


def _around(rows: slice, reach: int, frames: int) -> slice:
    """Return rows with `reach` more on either side, out to where windows may begin and end, of so many frames."""
    first = max(0, (rows.start - reach) // ALIGNMENT * ALIGNMENT)
    return slice(first, min(frames, -(-(rows.stop + reach) // ALIGNMENT) * ALIGNMENT))


def _within(outer: slice, inner: slice) -> slice:
    """Return a range, counted from the start of one that holds it."""
    return slice(inner.start - outer.start, inner.stop - outer.start)


def _with_velocity(curves: Tensor) -> Tensor:
    """Return curves, (batch, n, frames), and below them how they change over four frames."""
    held = pad(curves, (2, 2), mode="replicate")
    return torch.cat([curves, held[..., 4:] - held[..., :-4]], dim=1)


def _share(along: Tensor, begun: Tensor, bound: Tensor) -> Tensor:
    """Return the largest share, (batch, 1, frames), of each frame's departure that leaves it within a bound.

    Solves ``|begun + share * along| = radius``, both (batch, rows, frames) in the whitened space, where within the bound
    is within a ball.
    """
    out = begun.square().sum(dim=1, keepdim=True).sqrt()
    radius = torch.maximum(bound, out + ROOM * bound)
    across, square = (along * begun).sum(dim=1, keepdim=True), along.square().sum(dim=1, keepdim=True)
    reach = (across.square() + square * (radius - out) * (radius + out)).sqrt() - across
    return torch.where(square > reach, reach / square, 1.0)


def _median(curves: Tensor) -> Tensor:
    """Return the median of each five frames of curves, (batch, n, frames), by comparisons, which cost less than sorting."""
    held = pad(curves, (2, 2), mode="replicate")
    one, two, three, four, five = (held[..., shift : shift + curves.shape[2]] for shift in range(5))
    low = torch.maximum(torch.minimum(one, two), torch.minimum(four, five))
    high = torch.minimum(torch.maximum(one, two), torch.maximum(four, five))
    return torch.maximum(torch.minimum(low, high), torch.minimum(torch.maximum(low, high), three))


def network_of(area: Area, *, widths: tuple[int, int, int], waves: int = 0) -> AreaNetwork:
    """Build the untrained module of an area."""
    outputs = len(area.shape_columns)
    regressor = UNetConfig(len(area.controls), outputs, widths, waves, len(area.further))
    autoencoder = UNetConfig(outputs, outputs, widths)
    return AreaNetwork(regressor, autoencoder, held=area.held_inputs, shapes=area.shape_columns.tolist())


def from_config(config: dict[str, Any]) -> AreaNetwork:
    """Build a module from what `AreaNetwork.config` returned."""
    parts = [
        UNetConfig(**{**config[key], "widths": tuple(config[key]["widths"])}) for key in ("regressor", "autoencoder")
    ]
    return AreaNetwork(*parts, held=config["held"], shapes=config["shapes"])
