from __future__ import annotations

import torch

from engine.models.unet import ALIGNMENT, BatchNormUNet


def test_frames_stay_as_many_and_a_change_is_felt_as_far_as_the_network_looks() -> None:
    torch.manual_seed(0)
    network = BatchNormUNet(3, 2).eval()
    curves = torch.randn(1, 3, 16 * ALIGNMENT)
    plain = network(curves)
    assert plain.shape == (1, 2, 16 * ALIGNMENT)
    changed = curves.clone()
    changed[..., 32] += 1.0
    felt = torch.nonzero((network(changed) - plain).abs().amax(dim=(0, 1)) > 1e-7).flatten()
    assert felt.min() < 32 < felt.max() and felt.min() >= 32 - 16 and felt.max() <= 32 + 16
    moved = network(torch.roll(curves, ALIGNMENT, dims=2))
    torch.testing.assert_close(
        moved[..., 24:-16], torch.roll(plain, ALIGNMENT, dims=2)[..., 24:-16], atol=1e-5, rtol=1e-4
    )
