"""Block Cholesky factorisation of a symmetric block-tridiagonal matrix, O(f m^3), frame by frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotri

from engine.errors import EditError
from engine.take import Array, Mask

Blocks = Callable[[int, int], tuple[Array, Array]]


@dataclass(frozen=True)
class Tuning:
    """Limits of memory; ranges tried were not recorded."""

    chunk_frames: int = 256  # frames whose blocks are in memory at a time
    kept_frames: int = 4096  # longest take whose factor is kept; of longer ones it is computed again in the back sweep


TUNING = Tuning()


class BlockCholesky:
    """Solves ``H x = r`` for a symmetric positive definite H of f by f blocks with three non-zero block diagonals.

    With pivots ``P[t+1] = D[t+1] - C[t] P[t]^-1 C[t]'`` the solve is a forward and a back sweep. A factor of many
    frames would fill the memory: beyond `kept_frames` frames only the pivot that enters each chunk is kept, and the chunk is
    factorised anew on the way back.

    Parameters
    ----------
    blocks : returns diagonal blocks, (k, m, m), and blocks (t + 1, t), (k, m, m), of a range of frames t
    frames : f
    free : (f, m) bool, entries that are solved for; the others are left as the right side has them

    Raises
    ------
    EditError : where the matrix is singular
    """

    def __init__(self, blocks: Blocks, frames: int, free: Mask | None = None) -> None:
        self._blocks, self._frames, self._free = blocks, frames, free
        self._starts = range(0, frames, TUNING.chunk_frames)
        self._entering: list[Array | None] = [None]
        self._kept: list[tuple[Array, Array]] = []
        if frames <= TUNING.kept_frames:
            for index in range(len(self._starts)):
                self._kept.append(self._factorise(index))

    def _factorise(self, index: int) -> tuple[Array, Array]:
        """Return inverted pivots, (k, m, m), and gains ``C P^-1``, (k, m, m), of a chunk; store the pivot that enters the next."""
        start = self._starts[index]
        diagonal, coupling = self._masked(start, min(start + TUNING.chunk_frames, self._frames))
        inverses, gains = np.empty_like(diagonal), np.empty_like(diagonal)
        carried = self._entering[index]
        for frame, (block, ahead) in enumerate(zip(diagonal, coupling, strict=True)):
            inverse = _inverse(block if carried is None else block - carried)
            gain = ahead @ inverse
            carried = gain @ ahead.T
            inverses[frame], gains[frame] = inverse, gain
        if len(self._entering) == index + 1:
            self._entering.append(carried)
        return inverses, gains

    def _masked(self, start: int, stop: int) -> tuple[Array, Array]:
        diagonal, coupling = self._blocks(start, stop)
        if self._free is None:
            return diagonal, coupling
        here = self._free[start:stop]
        after = np.zeros_like(here)
        following = self._free[start + 1 : stop + 1]
        after[: len(following)] = following
        diagonal = diagonal * (here[:, :, None] & here[:, None, :])
        shapes = np.arange(diagonal.shape[1])
        diagonal[:, shapes, shapes] += ~here
        return diagonal, np.asarray(coupling * (after[:, :, None] & here[:, None, :]))

    def _factors(self, index: int) -> tuple[Array, Array]:
        return self._kept[index] if self._kept else self._factorise(index)

    def solve(self, right: Array) -> Array:
        """Return x, (f, m), of r, (f, m)."""
        reduced = np.array(right)
        carried = np.zeros(right.shape[1])
        for index, start in enumerate(self._starts):
            for frame, gain in enumerate(self._factors(index)[1], start):
                reduced[frame] += carried
                carried = -(gain @ reduced[frame])
        solved = np.empty_like(reduced)
        after = np.zeros(right.shape[1])
        for index in reversed(range(len(self._starts))):
            start = self._starts[index]
            inverses, gains = self._factors(index)
            alone = np.matmul(inverses, reduced[start : start + TUNING.chunk_frames, :, None])[..., 0]
            for offset in reversed(range(len(gains))):
                after = alone[offset] - after @ gains[offset]
                solved[start + offset] = after
        return solved


def _inverse(pivot: Array) -> Array:
    factor, failed = dpotrf(pivot, lower=1, clean=0)
    if failed:
        raise EditError("Nothing says where the motion starts.", "Pin a frame, or give the prior some strength.")
    inverse, _ = dpotri(factor, lower=1)
    lower = np.tril(inverse)
    return np.asarray(lower + np.tril(inverse, -1).T)
