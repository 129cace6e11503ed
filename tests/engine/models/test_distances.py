from __future__ import annotations

import numpy as np
import torch

from engine.character import bundled
from engine.controls import Measurer
from engine.models.distances import SIX, six_distances
from engine.take import SHAPES

RNG = np.random.default_rng(0)
SEEN = RNG.random((90, len(SHAPES))).astype(np.float32)


def test_distances_equal_the_measurer() -> None:
    weights = SEEN.astype(np.float64)
    expected = Measurer(bundled(), SIX).measure(weights) / 10
    np.testing.assert_allclose(six_distances(unit_mm=10.0)(torch.tensor(SEEN)[None])[0].numpy(), expected, atol=2e-3)


def test_the_mouth_closes_no_further_than_the_jaw_is_open_and_slopes_are_finite_at_contact() -> None:
    weights = torch.zeros(3, len(SHAPES))
    close, jaw = SHAPES.index("mouthClose"), SHAPES.index("jawOpen")
    weights[:, close] = torch.tensor([0.0, 0.5, 1.0])
    shut = six_distances()(weights)
    torch.testing.assert_close(shut, shut[:1].expand(3, -1))
    weights[:, jaw] = 0.5
    opened = six_distances()(weights)
    torch.testing.assert_close(opened[1], opened[2])
    assert (opened[0, :3] > opened[1, :3] + 1).all()
    weights.requires_grad_()
    six_distances()(weights).sum().backward()
    assert weights.grad is not None and torch.isfinite(weights.grad).all()
