"""A stretch of motion with missing values, and the guidance that there is for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.controls import CONTROLS
from engine.speech.visemes import NAMES
from engine.take import SHAPES, Array, Mask


@dataclass(frozen=True, eq=False)
class Gap:
    """A stretch of motion at the model rate with its context and guidance; NaN is what is not known.

    Attributes
    ----------
    known : (frames, 52) weights: context and pins; NaN where motion is to be generated
    guide : (frames, 52) weights of a rough performance to follow
    visemes : (frames, 18) one-hot, all zero at a frame without a viseme
    controls : (frames, 8) mm, target curves of the controls
    rest : (frames, 52) each, further stretches of the same take without gaps, at the model rate, for retrieval
    """

    known: Array
    guide: Array
    visemes: Array
    controls: Array
    rest: Sequence[Array] = ()

    @property
    def guided(self) -> Mask:
        """Which frames have a guide, a viseme or a control target, (frames,) bool."""
        guided = np.isfinite(self.guide).any(axis=1) | np.isfinite(self.controls).any(axis=1)
        return np.asarray(guided | self.visemes.any(axis=1))


def gap_of(
    known: Array,
    *,
    guide: Array | None = None,
    visemes: Array | None = None,
    controls: Array | None = None,
    rest: Sequence[Array] = (),
) -> Gap:
    """Return a gap; guidance that is not given is filled in as none."""
    frames = len(known)
    return Gap(
        known,
        np.full((frames, len(SHAPES)), np.nan) if guide is None else guide,
        np.zeros((frames, len(NAMES))) if visemes is None else visemes,
        np.full((frames, len(CONTROLS)), np.nan) if controls is None else controls,
        rest,
    )
