"""The assembled system, solved as a whole: slow, large and obviously right."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from engine.spacetime.system import System
from engine.take import Array, Mask


def stacked(system: System, source: Array, places: Array | None) -> tuple[sparse.csc_matrix, Array]:
    """Rows of the least-squares problem ``|A vec(W) - b|^2``, term by term, vec(W) frame by frame."""
    frames, count = system.frames, system.count
    difference = sparse.diags_array([-np.ones(frames), np.ones(frames)], offsets=[0, 1], shape=(frames - 1, frames))
    every = sparse.eye_array(frames)
    confidence = np.ones_like(source[1:]) if system.confidence is None else np.sqrt(system.confidence)
    confidence = confidence.ravel()
    own = np.sqrt(system.stiffness * (system.basis**2).sum(axis=0).mean())
    rows = [
        sparse.diags_array(confidence) @ sparse.kron(difference, system.basis),
        own * sparse.kron(difference, sparse.eye_array(count)),
    ]
    sides = [confidence * np.diff(source, axis=0).ravel(), np.zeros((frames - 1) * count)]
    if system.prior is not None:
        rows.append(np.sqrt(system.alpha) * sparse.kron(every, system.prior.factor))
        sides.append(np.sqrt(system.alpha) * np.tile(system.prior.offset, frames))
    if system.position is not None:
        strength = np.sqrt(np.broadcast_to(system.position.weights, (frames, len(system.position.rows)))).ravel()
        rows.append(sparse.diags_array(strength) @ sparse.kron(every, system.position.rows))
        sides.append(strength * (np.zeros(len(strength)) if places is None else places.ravel()))
    return sparse.csc_matrix(sparse.vstack(rows)), np.concatenate(sides)


def solve(system: System, source: Array, held: Mask, values: Array, places: Array | None = None) -> Array:
    """Weights, (f, m), by the normal equations over the weights that are not held, refined once."""
    matrix, side = stacked(system, source, places)
    flat, free = np.where(held, values, 0.0).ravel(), np.flatnonzero(~held.ravel())
    side = side - matrix @ flat
    matrix = matrix[:, free]
    normal = sparse.csc_matrix(matrix.T @ matrix)
    factor = splu(normal, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    found = factor.solve(matrix.T @ side)
    for _ in range(2):
        found += factor.solve(matrix.T @ (side - matrix @ found))
    flat[free] = found
    return flat.reshape(held.shape)
