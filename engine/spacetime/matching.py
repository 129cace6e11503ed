"""The settings of movement matching, apart from the solver, so that a request loads none."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Bounds:
    """The range that weights must stay in; pins may lie outside."""

    low: float = 0.0
    high: float = 1.0


@dataclass(frozen=True)
class Matching:
    """The weights of the terms beside the source's velocities (SLS12 equation 4, section 7.1).

    Attributes
    ----------
    alpha : weight of the prior at 30 fps; the same on any head (SLS12 equation 4)
    beta : weight of the markers' positions beside their velocities at 30 fps (section 7.1); with velocities alone a
        pose of long duration would sink back to rest
    closure : weight by which lips and lids that meet in the source meet in the target
    bounds : range of the weights, which most programs cut off beyond 0..1; None for the paper's free weights
    """

    alpha: float = 0.005
    beta: float = 0.1
    closure: float = 10.0
    bounds: Bounds | None = field(default_factory=Bounds)
