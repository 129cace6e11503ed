"""Figures of merit for filled motion: spectra, closures, seams, variety, and how alike two bodies of motion are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import sqrtm

from engine.controls import CONTROL_INDEX, bundled_measurer
from engine.take import Array, Mask

CLOSED_MM = 3.0
_CLOSING = [CONTROL_INDEX[name] for name in ("lips_vertical", "eyelid_right", "eyelid_left")]


def npss(truths: Sequence[Array], result: Sequence[Array]) -> float:
    """Return the normalised power spectrum similarity of pairs of stretches, (frames, shapes) each; 0 is best.

    Earth mover's distance between normalised power spectra of every shape, weighted by the truth's power
    (Gopalakrishnan et al. 2019, "A neural temporal model for human motion prediction", section 4.2).
    """
    total, weights = 0.0, 0.0
    for truth, other in zip(truths, result, strict=True):
        power, power_made = (np.abs(np.fft.rfft(curve, axis=0)) ** 2 for curve in (truth, other))
        amount = power.sum(axis=0)
        shares = [np.cumsum(p / np.maximum(p.sum(axis=0), 1e-12), axis=0) for p in (power, power_made)]
        total += float((np.abs(shares[0] - shares[1]).sum(axis=0) * amount).sum())
        weights += float(amount.sum())
    return total / max(weights, 1e-12)


def frechet(truths: Array, result: Array) -> float:
    """Return the Fréchet distance between Gaussians fitted to two sets of latents, (n, latents) each; 0 is best.

    ``|m1 - m2|^2 + tr(C1 + C2 - 2 (C1 C2)^1/2)`` (Heusel et al. 2017, equation 6).
    """
    means = [latents.mean(axis=0) for latents in (truths, result)]
    ridge = 1e-6 * np.eye(truths.shape[1])
    first, second = (np.cov(latents, rowvar=False) + ridge for latents in (truths, result))
    cross = np.real(sqrtm(first @ second))
    return float(((means[0] - means[1]) ** 2).sum() + np.trace(first + second - 2 * cross))


def closures(truths: Sequence[Array], result: Sequence[Array]) -> tuple[float, float]:
    """Return which share of closed frames are closed and which share of open ones are too, lips and lids together.

    Pairs of stretches, (frames, 52) each; NaN where the truth has none. Closed is below `CLOSED_MM`.
    """
    measure = bundled_measurer().measure
    closed = [np.concatenate([measure(each)[:, _CLOSING] for each in many]) < CLOSED_MM for many in (truths, result)]
    truly, falsely = closed[1][closed[0]], closed[1][~closed[0]]
    return (float(truly.mean()) if len(truly) else np.nan), (float(falsely.mean()) if len(falsely) else np.nan)


def seam_jumps(weights: Array, hole: Mask) -> tuple[float, float]:
    """Return the mean change of value and of slope across the seams of a hole, (frames, 52), over its shapes.

    The change of value is the step from the last known frame to the first made one; that of slope, how much this step
    differs from the one before it. Both are of the made side, whatever the truth does there.
    """
    rows, shapes = np.flatnonzero(hole.any(axis=1)), hole.any(axis=0)
    steps, turns = [], []
    for edge, way in ((rows[0], 1), (rows[-1], -1)):
        if 0 <= edge - 2 * way < len(weights):
            before, last, first = (weights[edge - k * way, shapes] for k in (2, 1, 0))
            steps.append(np.abs(first - last).mean())
            turns.append(np.abs(first - 2 * last + before).mean())
    return (float(np.mean(steps)), float(np.mean(turns))) if steps else (np.nan, np.nan)


def variety(fills: Array) -> float:
    """Return the mean distance between pairs of fills of one gap, (fills, frames, shapes): root mean square over shapes."""
    pairs = [(each, other) for each in range(len(fills)) for other in range(each)]
    return float(np.mean([np.sqrt(((fills[a] - fills[b]) ** 2).mean()) for a, b in pairs]))
