"""What matching movement is asked for; apart from how it is done, so that asking loads no solver."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Bounds:
    """The range that weights must stay in; pins may lie outside."""

    low: float = 0.0
    high: float = 1.0


@dataclass(frozen=True)
class Matching:
    """What a retarget is asked to respect, beside the source's velocities.

    Attributes
    ----------
    alpha : how much the target's likely poses count, at 30 fps; the same on any head (SLS12 equation 4)
    beta : how much the markers' places count beside their velocities, at 30 fps (section 7.1); velocities alone would
        let a long-held pose sink back to rest
    closure : how much lips and lids that meet in the source are to meet in the target
    bounds : range of the weights, which most programs cut off beyond 0..1; None for the paper's free weights
    """

    alpha: float = 0.005
    beta: float = 0.1
    closure: float = 10.0
    bounds: Bounds | None = field(default_factory=Bounds)
