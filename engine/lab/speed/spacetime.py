"""How fast movement matching is: the paper's example, a range edit, and whether time per frame stays flat."""

from __future__ import annotations

import time

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from engine.lab.speed.timing import Speed, percentile_ms
from engine.spacetime.pin import PinSolver
from engine.spacetime.prior import from_shapes
from engine.spacetime.solve import MovementMatcher
from engine.spacetime.system import System
from engine.take import SHAPES, Array, Mask, Take

FRAMES, SHAPE_COUNT, MARKERS = 1500, 50, 54  # the paper's largest example, which took it 47.38 s
ALPHA = 0.01
LENGTHS = (2_000, 20_000, 200_000)
SLIDER = "mouthSmileLeft"


def measure() -> list[Speed]:
    """Return the figures; the sparse solve of the assembled system runs once, in the same run."""
    basis, source, fixed = _problem(FRAMES)
    fast_ms = percentile_ms(lambda _: _solve(basis, source, fixed), 20, percentile=50.0)
    began = time.perf_counter()
    plain = _sparse(basis, source, fixed)
    sparse_ms = (time.perf_counter() - began) * 1e3
    difference = float(np.abs(plain - _solve(basis, source, fixed)).max())
    per_frame = [_long_ms(frames) / frames * 1e3 for frames in LENGTHS]
    return [
        Speed("spacetime_1500x50_ms", fast_ms, "ms", 25.0),
        Speed("speedup_vs_sparse", sparse_ms / fast_ms, "times", 100.0, at_least=True),
        Speed("spacetime_difference_from_sparse", difference, "weight", 1e-6),
        Speed("spacetime_range12_ms", _slider_ms(12), "ms", 1.0),
        Speed("spacetime_range300_ms", _slider_ms(300), "ms", 16.0),
        Speed("spacetime_frame_us_at_200000", per_frame[-1], "us", 25.0),
        Speed("spacetime_flatness", per_frame[-1] / per_frame[0], "times", 1.5),
    ]


def _problem(frames: int) -> tuple[Array, Array, Mask]:
    rng = np.random.default_rng(0)
    basis = rng.normal(size=(3 * MARKERS, SHAPE_COUNT))
    fixed = np.zeros((frames, SHAPE_COUNT), bool)
    fixed[[0, -1]] = True
    return basis, rng.normal(size=(frames, 3 * MARKERS)), fixed


def _solve(basis: Array, source: Array, fixed: Mask) -> Array:
    system = System(basis, len(source), from_shapes(basis), ALPHA)
    return MovementMatcher(system, fixed).solve(source)


def _sparse(basis: Array, source: Array, fixed: Mask) -> Array:
    """Solve the assembled system at rest in the held frames, (SLS12 eq. 5): the plain way, in its banded order."""
    frames, prior = len(source), from_shapes(basis)
    path = sparse.csr_array(np.diff(sparse.eye_array(frames).toarray(), axis=0))
    free = np.flatnonzero(~fixed.any(axis=1))
    laplacian = sparse.csc_array(path.T @ path)[free][:, free]
    every = sparse.eye_array(len(free))
    system = System(basis, frames, prior, ALPHA)
    matrix = sparse.kron(laplacian, system.velocity_gram()) + sparse.kron(every, system.constant_gram())
    right = (np.asarray(path.T @ (path @ source)) @ basis)[free]
    options = {"SymmetricMode": True}
    factor = splu(sparse.csc_matrix(matrix), permc_spec="NATURAL", diag_pivot_thresh=0.0, options=options)
    weights = np.zeros((frames, SHAPE_COUNT))
    weights[free] = factor.solve(right.ravel()).reshape(len(free), SHAPE_COUNT)
    return weights


def _slider_ms(frames: int) -> float:
    """Return the time of one step of a slider while its pin's range is solved anew, closures held."""
    rng = np.random.default_rng(1)
    curves = np.cumsum(rng.normal(size=(frames + 40, len(SHAPES))), axis=0)
    take = Take(np.clip(0.1 + 0.02 * curves, 0, 1), 30.0)
    pinned = 20 + frames // 2
    solver = PinSolver(take, {pinned: {SLIDER: 0.0}}, (20, 20 + frames))
    return percentile_ms(lambda step: solver.solve({pinned: {SLIDER: step / 200}}), 200)


def _long_ms(frames: int, rounds: int = 3) -> float:
    """Return the shortest time of a whole solve of a take of any length."""
    basis, _, _ = _problem(2)
    fixed = np.zeros((frames, SHAPE_COUNT), bool)
    fixed[[0, -1]] = True
    right = np.ones((frames, SHAPE_COUNT))
    system = System(basis, frames, from_shapes(basis), ALPHA)
    spent = []
    for _ in range(rounds):
        began = time.perf_counter()
        MovementMatcher(system, fixed).settle(right)
        spent.append(time.perf_counter() - began)
    return min(spent) * 1e3
