"""What a network says, brought onto the controls it was asked for: Gauss and Newton's steps as a layer of the network.

A face that was recorded has exactly the controls that are measured on it, so that of all faces near the network's the
nearest with these controls is the better guess: in the metric of the network's own errors, the projection onto them.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from engine.controls import ALL_INDEX
from engine.extended import LENGTH, TERMS, bundled_face
from engine.take import SHAPE_INDEX

ROUNDS, ROUNDS_TRAINING = 6, 3  # lips of people never seen need more; a training takes half as long again with all six
NOISE_MM2 = 0.01  # of a control, at first; training finds its own. Smaller, and lids that touch throw each other about
TOLERANCE_MM = 8.0  # a miss by this much is believed by 1/e: the request may be a mistake, which the autoencoder mended
_LEAST_MM2 = 1e-6


class Constraint(nn.Module):
    """Moves an area's weights to where its controls are as asked, by steps ``S J^T (J S J^T + N)^-1 (asked - C(w))``.

    S is the covariance of the errors of the weights, J the slope of the controls C by them, N the noise of the controls.

    Parameters
    ----------
    controls : by name, lengths and places alone
    shapes : columns of the weights that may move
    """

    rest: Tensor
    basis: Tensor
    others: Tensor
    means: Tensor
    axes: Tensor
    long: Tensor
    covariance: Tensor

    def __init__(self, controls: Sequence[str], shapes: Sequence[int]) -> None:
        super().__init__()
        terms = [(place, *term) for place, name in enumerate(controls) for term in TERMS[ALL_INDEX[name]]]
        rows = [row for _, row, _, _ in terms]
        rest, basis = (torch.tensor(part, dtype=torch.float32) for part in bundled_face().linear)
        basis = basis[:, rows]  # (52, terms, 3)
        elsewhere = basis.clone()
        elsewhere[list(shapes)] = 0.0
        means = torch.zeros(len(controls), len(terms))
        for index, (place, *_) in enumerate(terms):
            means[place, index] = 1.0
        fixed = {
            "rest": rest[rows],
            "basis": basis[list(shapes)].permute(1, 2, 0).contiguous(),  # (terms, 3, shapes)
            "others": elsewhere.flatten(1),  # (52, terms * 3)
            "means": means / means.sum(dim=1, keepdim=True),
            "axes": torch.eye(3)[[axis for *_, axis in terms]],
            "long": torch.tensor([kind == LENGTH for _, _, kind, _ in terms])[:, None],
        }
        for name, tensor in fixed.items():
            self.register_buffer(name, tensor, persistent=False)  # of the head, not of the training
        self.register_buffer("covariance", 0.01 * torch.eye(len(shapes)))
        self.noise = nn.Parameter(torch.full((len(controls),), NOISE_MM2).log())
        self.tolerance = nn.Parameter(torch.full((len(controls),), TOLERANCE_MM).log())
        at = {column: index for index, column in enumerate(shapes)}
        self._jaw, self._close = at.get(SHAPE_INDEX["jawOpen"]), at.get(SHAPE_INDEX["mouthClose"])

    def forward(self, weights: Tensor, asked: Tensor, still: Tensor | None = None, *, doubting: bool) -> Tensor:
        """Return weights, (batch, shapes, frames) in 0..1, of asked controls, (batch, controls, frames), NaN where none is.

        `still`, (batch, 52, frames), is the face whose other shapes stay as they are. `doubting` believes a control the
        less, the more the weights miss it.
        """
        batch, count, frames = weights.shape
        flat = asked.mT.reshape(batch * frames, -1)
        given = ~flat.isnan()
        around = self.rest.expand(batch * frames, -1, -1)
        if still is not None:
            around = around + (still.mT @ self.others).view(batch * frames, -1, 3)
        made = weights.mT.reshape(batch * frames, count).clamp(0.0, 1.0)
        for _ in range(ROUNDS_TRAINING if self.training else ROUNDS):
            made = self._step(made, flat.nan_to_num(), given, around, doubting=doubting).clamp(0.0, 1.0)
        return made.view(batch, frames, count).mT

    def _step(self, weights: Tensor, asked: Tensor, given: Tensor, around: Tensor, *, doubting: bool) -> Tensor:
        read, slope = self._measured(weights, around)
        miss = torch.where(given, asked - read, 0.0)
        slope = slope * given[:, :, None]
        if doubting:
            miss = miss * torch.exp(-((miss.detach() / self.tolerance.exp()) ** 2))
        spread = slope @ self.covariance  # (n, controls, shapes)
        gram = spread @ slope.mT + torch.diag(self.noise.exp())
        pull = torch.linalg.solve(gram, miss[:, :, None])
        stepped: Tensor = weights + (pull.mT @ spread)[:, 0]
        return stepped

    def _measured(self, weights: Tensor, around: Tensor) -> tuple[Tensor, Tensor]:
        """Return controls, (n, controls), and their slopes, (n, controls, shapes), of weights, (n, shapes)."""
        moved = (self._drawn(weights) @ self.basis.flatten(0, 1).T).view(around.shape)
        vectors = around + moved  # (n, terms, 3)
        lengths = (vectors.square().sum(dim=2, keepdim=True) + _LEAST_MM2).sqrt()
        along = torch.where(self.long, vectors / lengths, self.axes)
        read = torch.where(self.long, lengths, (vectors * self.axes).sum(dim=2, keepdim=True))[..., 0]
        slope = (along.transpose(0, 1) @ self.basis).transpose(0, 1)  # (n, terms, shapes)
        return read @ self.means.T, self.means @ self._followed(slope, weights)

    def _drawn(self, weights: Tensor) -> Tensor:
        """Return weights whose lips close no further than the jaw has opened, as the character is drawn."""
        if self._jaw is None or self._close is None:
            return weights
        close = torch.minimum(weights[:, self._close], weights[:, self._jaw].clamp(min=0.0))
        return torch.cat([weights[:, : self._close], close[:, None], weights[:, self._close + 1 :]], dim=1)

    def _followed(self, slope: Tensor, weights: Tensor) -> Tensor:
        """Return slopes in which lips that close as far as the jaw has opened follow it instead of their own weight."""
        if self._jaw is None or self._close is None:
            return slope
        joined = (weights[:, self._close] > weights[:, self._jaw])[:, None]
        of_close = slope[..., self._close]
        columns = list(slope.unbind(dim=2))
        columns[self._jaw] = columns[self._jaw] + torch.where(joined, of_close, 0.0)
        columns[self._close] = torch.where(joined, 0.0, of_close)
        return torch.stack(columns, dim=2)
