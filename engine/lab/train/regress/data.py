"""What the networks of this package and their baselines are trained on: windows of faces and of their controls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import torch
from scipy.spatial import cKDTree
from torch import Tensor

from engine.anatomy import mirrored
from engine.extended import bundled_face
from engine.lab.corpus import Piece, person_of, whole_faces
from engine.lab.performer.augment import Levers, augment
from engine.lab.performer.corpus import synthetic_performances
from engine.models.windows import windows
from engine.regress.areas import Area
from engine.take import SHAPES, Array

NEAREST = 6  # real faces that the target of an impossible request is the mean of
BANK = 12_000  # faces among which they are looked for
OUTWEIGH = 4.0  # times the frames of the median person that one person may have in an epoch


@dataclass(frozen=True)
class Windows:
    """Windows with the controls measured on them.

    Attributes
    ----------
    controls : (windows, 16, frames) float32, the eight controls in mm and the extended ones
    weights : (windows, 52, frames) float32
    """

    controls: Tensor
    weights: Tensor


def cut(pieces: Sequence[Array], *, length: int, overlap: float) -> Windows:
    """Cut pieces, (frames, 52) each, into windows and measure their controls."""
    weights = np.concatenate([windows(piece, length=length, overlap=overlap) for piece in pieces])
    flat = weights.reshape(-1, len(SHAPES))
    measured = bundled_face().measure(flat)
    controls = measured.reshape(*weights.shape[:2], -1)
    return Windows(*(torch.tensor(x.transpose(0, 2, 1), dtype=torch.float32) for x in (controls, weights)))


@dataclass(frozen=True)
class Source:
    """Endless training windows for one area: every epoch sees people played anew, each about as long.

    Attributes
    ----------
    pieces : (frames, 52) each, recorded
    people : whose each of them is
    synthetic : (frames, 52) each, performed; none if empty
    """

    pieces: tuple[Array, ...]
    people: tuple[str, ...]
    synthetic: tuple[Array, ...]
    levers: Levers
    seed: int
    window: int

    def epoch(self, *key: int) -> Windows:
        """Return the windows of an epoch; the same key gives the same windows."""
        rng = np.random.default_rng([self.seed, *key])
        played = augment(self._drawn(rng), self.levers, rng)
        played += augment(self.synthetic, replace(self.levers, copies=1), rng)[len(self.synthetic) :]
        offset = [piece[int(rng.integers(max(1, len(piece) - self.window))) % self.window :] for piece in played]
        return cut(offset, length=self.window, overlap=0.0)

    def _drawn(self, rng: np.random.Generator) -> list[Array]:
        """Return pieces drawn so that nobody has many more frames than the others: a network learns who is most seen."""
        frames = {person: 0 for person in self.people}
        for piece, person in zip(self.pieces, self.people, strict=True):
            frames[person] += len(piece)
        most = OUTWEIGH * float(np.median(list(frames.values())))
        chosen, drawn = [], dict.fromkeys(self.people, 0)
        for index in rng.permutation(len(self.pieces)).tolist():
            person = self.people[index]
            if drawn[person] < most:
                chosen.append(index)
                drawn[person] += len(self.pieces[index])
        return [self.pieces[index] for index in sorted(chosen)]

    @cached_property
    def recorded(self) -> dict[str, Windows]:
        """The windows of each person as they were recorded, and in a mirror."""
        found = {}
        for person in dict.fromkeys(self.people):
            own = [piece for piece, whose in zip(self.pieces, self.people, strict=True) if whose == person]
            found[person] = cut([*own, *map(mirrored, own)], length=self.window, overlap=0.0)
        return found

    @cached_property
    def first(self) -> Windows:
        """The windows from which constants are taken: means, ranges, the linear start."""
        return self.epoch(0)


def source(area: Area, pieces: Sequence[Piece], levers: Levers, *, minutes: float, seed: int, window: int) -> Source:
    """Return the training material of an area: its recorded pieces and synthetic performances of some minutes."""
    chosen = whole_faces(pieces) if area.needs_whole_face else pieces
    performed = synthetic_performances(minutes, seed=seed) if minutes else []
    people = tuple(person_of(piece.source) for piece in chosen)
    return Source(tuple(piece.weights for piece in chosen), people, tuple(performed), levers, seed, window)


class NearestFaces:
    """The real face whose controls come nearest to what was asked: the target where a request has no truth.

    Parameters
    ----------
    faces : windows to look among
    columns, shapes : controls that are compared, weights that are returned
    """

    def __init__(self, faces: Windows, columns: Tensor, shapes: Tensor, seed: int) -> None:
        controls = faces.controls[:, columns].permute(0, 2, 1).reshape(-1, len(columns)).numpy()
        weights = faces.weights[:, shapes].permute(0, 2, 1).reshape(-1, len(shapes)).numpy()
        chosen = np.random.default_rng(seed).permutation(len(controls))[:BANK]
        self._scale = np.maximum(controls.std(axis=0), 0.1)
        self._weights = weights[chosen]
        self._tree = cKDTree(controls[chosen] / self._scale)

    def weights(self, controls: Tensor) -> Tensor:
        """Return weights, (batch, shapes, frames), for asked controls, (batch, controls, frames) in mm."""
        batch, count, frames = controls.shape
        flat = controls.permute(0, 2, 1).reshape(-1, count).numpy()
        distance, index = self._tree.query(flat / self._scale, k=NEAREST)
        closeness = 1.0 / (np.asarray(distance) ** 2 + 0.05)
        closeness /= closeness.sum(axis=1, keepdims=True)
        mean = (closeness[:, :, None] * self._weights[index]).sum(axis=1)
        return torch.tensor(mean.reshape(batch, frames, -1).transpose(0, 2, 1), dtype=torch.float32)
