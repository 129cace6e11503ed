from __future__ import annotations

import numpy as np
import torch

from engine.inpaint.network import TUNING, Discriminator, Generator, GeneratorConfig, discriminator_inputs, noise_curves
from engine.models.distances import six_distances
from engine.take import SHAPES

SMALL = GeneratorConfig(features=5, noise=8, hidden=6, layers=1, dropout=0.0, filter_frames=9)


def test_noise_has_unit_variance_and_forgets_itself_at_each_curve_s_own_pace() -> None:
    curves = noise_curves(40_000, np.random.default_rng(0)).astype(float)
    assert curves.shape == (40_000, 8) and noise_curves(3, np.random.default_rng(0)).dtype == np.float32
    slow = np.array(TUNING.memory_frames)
    np.testing.assert_allclose(curves.std(axis=0), 1, atol=0.02 + 0.0015 * slow.max())
    for column, memory in enumerate(TUNING.memory_frames):
        kept = np.corrcoef(curves[1:, column], curves[:-1, column])[0, 1]
        assert abs(kept - (np.exp(-1 / memory) if memory else 0.0)) < 0.02
    np.testing.assert_array_equal(
        noise_curves(50, np.random.default_rng(1))[:20], noise_curves(50, np.random.default_rng(1))[:20]
    )
    first = np.array([noise_curves(1, np.random.default_rng(seed))[0] for seed in range(2000)])
    np.testing.assert_allclose(first.std(axis=0), 1, atol=0.06)


def test_a_fresh_generator_adds_no_motion_and_a_moved_one_sees_no_feature_beyond_its_limit() -> None:
    torch.manual_seed(0)
    network = Generator(SMALL).eval()
    features, noise = torch.randn(2, 30, 5), torch.randn(2, 30, 8)
    assert network(features, noise).shape == (2, 30, len(SHAPES)) and not network(features, noise).any()
    torch.nn.init.normal_(network.dense.weight, std=0.2)
    torch.nn.init.normal_(network.filter.weight, std=0.2)
    far, limit = features.clone(), features.clone()
    far[:, 3, 2], limit[:, 3, 2] = 900.0, 8.0
    torch.testing.assert_close(network(far, noise), network(limit, noise))
    network.scale.fill_(3.0)
    torch.testing.assert_close(network(far, noise), 3 * network(limit, noise) / 3)
    moved = network(limit, noise)
    network.scale.fill_(1.0)
    torch.testing.assert_close(moved, 3 * network(limit, noise))


def test_a_discriminator_sees_poses_distances_and_their_velocities() -> None:
    weights, distances = torch.rand(2, 17, len(SHAPES)), six_distances(unit_mm=10.0)
    seen = discriminator_inputs(weights, distances)
    assert seen.shape == (2, 17, 116)
    torch.testing.assert_close(seen[..., :52], weights)
    torch.testing.assert_close(seen[..., 52:58], distances(weights))
    torch.testing.assert_close(seen[:, 1:, 58:], seen[:, 1:, :58] - seen[:, :-1, :58])
    assert not seen[:, 0, 58:].any()
    for frames in (16, 17, 31):
        assert Discriminator(frames, widths=(4, 3))(
            discriminator_inputs(torch.rand(5, frames, 52), distances)
        ).shape == (5,)
