"""What movement matching is compared with: retargeting each frame by itself (SLS12 section 7)."""

from __future__ import annotations

import numpy as np

from engine.spacetime.retarget import Correspondence
from engine.take import Array

RIDGE = 1e-9  # of the strongest direction: shapes that cancel exactly stay finite
RANGE = (-0.5, 1.5)  # the paper's
ROUNDS = 60
SETTLED = 1e-9  # of a weight


def _normal(pair: Correspondence) -> tuple[Array, Array]:
    """Return the Gram matrix, (m, m), and right sides, (frames, m), of ``min |B w - s|^2``."""
    gram = pair.basis.T @ pair.basis
    return gram + RIDGE * np.linalg.eigvalsh(gram)[-1] * np.eye(len(gram)), pair.motion @ pair.basis


def per_frame(pair: Correspondence) -> Array:
    """Return weights, (frames, m), that fit each frame's markers best, whatever their size: Chuang and Bregler 2002."""
    gram, right = _normal(pair)
    return np.asarray(np.linalg.solve(gram, right.T).T)


def per_frame_prior(pair: Correspondence, alpha: float) -> Array:
    """Return weights, (frames, m), that fit each frame and are likely: Blanz and Vetter 1999."""
    gram, right = _normal(pair)
    prior = pair.prior
    gram = gram + alpha * prior.scale(pair.basis) * (prior.factor.T @ prior.factor)
    return np.asarray(np.linalg.solve(gram, right.T).T)


def per_frame_bounded(pair: Correspondence, low: float = RANGE[0], high: float = RANGE[1]) -> Array:
    """Return weights, (frames, m), that fit each frame within a range: Bregler et al. 2002.

    Projected Newton for all frames at once: weights that press against a bound sit out a step, whose length is chosen
    for each frame by halving until the cost falls.
    """
    gram, right = _normal(pair)
    weights: Array = np.clip(np.linalg.solve(gram, right.T).T, low, high)
    active = np.arange(len(weights))
    for _ in range(ROUNDS):
        here, side = weights[active], right[active]
        slope = here @ gram - side
        target = np.clip(here - slope / np.diag(gram), low, high) - here
        going = np.abs(target).max(axis=1) > SETTLED
        if not going.any():
            break
        active, here, side, slope = active[going], here[going], side[going], slope[going]
        free = ~np.where(slope > 0, here <= low, here >= high)
        masked = gram * (free[:, :, None] & free[:, None, :])
        shapes = np.arange(gram.shape[0])
        masked[:, shapes, shapes] += ~free
        step = np.linalg.solve(masked, np.where(free, -slope, 0.0)[..., None])[..., 0]
        weights[active] = _search(here, step, slope=slope, gram=gram, low=low, high=high)
    return weights


def _search(here: Array, step: Array, *, slope: Array, gram: Array, low: float, high: float) -> Array:
    length = np.ones((len(here), 1))
    for _ in range(30):
        moved = np.clip(here + length * step, low, high)
        change = moved - here
        gained = (change * slope).sum(axis=1) + 0.5 * (change * (change @ gram)).sum(axis=1)
        poor = gained > 1e-4 * (change * slope).sum(axis=1)
        if not poor.any():
            break
        length[poor] *= 0.5
    return np.asarray(moved)
