"""Samples as a speech decoder takes them: one channel, 16 kHz, 16 bit, with a little noise so that silence is heard as such."""

from __future__ import annotations

from math import gcd

import numpy as np
import numpy.typing as npt

from engine.take import Array

RATE = 16_000  # Hz, of the acoustic model
NOISE = 1e-4  # root mean square of what is added, −80 dB; digital silence is heard as S without it
QUIET = 1e-3  # root mean square of the loudest tenth of a second below which nothing is said, −60 dB
_FULL = 32_767


def speech_samples(samples: npt.NDArray[np.floating], rate: int) -> Array:
    """Return one channel at 16 kHz, (m,), of samples, (n,) or (n, channels); what lies above 8 kHz is filtered out."""
    mono = np.asarray(samples, np.float64)
    mono = mono.mean(axis=1) if mono.ndim > 1 else mono
    if rate == RATE or not len(mono):
        return mono
    from scipy.signal import resample_poly

    common = gcd(RATE, rate)
    return np.asarray(resample_poly(mono, RATE // common, rate // common), np.float64)


def dithered(samples: Array) -> bytes:
    """Return samples at 16 kHz as 16-bit numbers, the same noise added at every call."""
    noise = NOISE * np.random.default_rng(0).standard_normal(len(samples))
    return np.rint(np.clip(samples + noise, -1, 1) * _FULL).astype("<i2").tobytes()


def is_silent(samples: Array) -> bool:
    """Return whether no tenth of a second of samples at 16 kHz is loud enough to be speech."""
    part = RATE // 10
    whole = samples[: len(samples) // part * part].reshape(-1, part)
    loudest = np.square(whole).mean(axis=1).max() if len(whole) else 0.0
    return bool(max(loudest, np.square(samples).mean() if len(samples) else 0.0) < QUIET**2)
