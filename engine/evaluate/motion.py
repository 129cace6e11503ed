"""Figures of merit for motion: spectra, latent distances, closures and seams."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from engine.take import Array


def npss(truths: Sequence[Array], made: Sequence[Array]) -> float:
    """Return the normalised power spectrum similarity of pairs of stretches, (frames, shapes) each; 0 is best.

    Earth mover's distance between normalised power spectra of every shape, weighted by the truth's power
    (Gopalakrishnan et al. 2019, "A neural temporal model for human motion prediction", equations 5 to 7).
    """
    total, weights = 0.0, 0.0
    for truth, other in zip(truths, made, strict=True):
        power, power_made = (np.abs(np.fft.rfft(curve, axis=0)) ** 2 for curve in (truth, other))
        amount = power.sum(axis=0)
        shares = [np.cumsum(p / np.maximum(p.sum(axis=0), 1e-12), axis=0) for p in (power, power_made)]
        total += float((np.abs(shares[0] - shares[1]).sum(axis=0) * amount).sum())
        weights += float(amount.sum())
    return total / max(weights, 1e-12)
