from __future__ import annotations

import torch

from engine.regress.network import BEYOND, AreaNetwork
from engine.regress.unet import UNetConfig


def _tempered(controls: torch.Tensor) -> AreaNetwork:
    network = AreaNetwork(UNetConfig(3, 2, (4, 4, 4)), UNetConfig(2, 2, (4, 4, 4)))
    network.learn_bounds(controls, 0.05)
    return network


def test_what_was_recorded_is_tempered_hardly_ever() -> None:
    torch.manual_seed(0)
    controls = torch.randn(20, 3, 256).cumsum(dim=2) * 0.1
    network = _tempered(controls)
    made, scale = network.tempered(controls)
    whole = (scale == 1).float().mean()
    assert 0.5 < whole < 1 - BEYOND and scale.mean() > 0.97
    kept = (scale == 1).expand_as(made)
    torch.testing.assert_close(made[kept], controls[kept])


def test_exaggerated_motion_is_scaled_as_a_whole_to_what_was_recorded() -> None:
    time = torch.arange(128) / 10
    controls = torch.stack([time.sin(), time.cos(), (1.3 * time).sin()])[None] + 5.0
    network = _tempered(controls)
    asked = 5.0 + 8 * (controls - 5.0)
    made, _ = network.tempered(asked)
    inner = slice(20, -20)
    away = [(one - network.centre)[..., inner] for one in (made, controls, asked)]
    assert away[1].abs().max() < away[0].abs().max() < 0.5 * away[2].abs().max()
    ratio = away[0] / away[2]
    torch.testing.assert_close(ratio, ratio[:, :1].expand_as(ratio), atol=1e-4, rtol=1e-3)


def test_pepper_is_scaled_alone() -> None:
    time = torch.arange(128) / 10
    controls = torch.stack([time.sin(), time.cos(), (1.3 * time).sin()])[None]
    network = _tempered(controls)
    quiet = 0.5 * controls
    asked = quiet.clone()
    asked[..., 60] = 100.0
    made, _ = network.tempered(asked)
    assert (made[..., 60] - network.centre[..., 0]).abs().max() < 3.0
    torch.testing.assert_close(made[..., :50], quiet[..., :50])
    torch.testing.assert_close(made[..., 70:], quiet[..., 70:])


def test_what_a_take_does_itself_is_never_tempered() -> None:
    controls = torch.randn(20, 3, 256, generator=torch.Generator().manual_seed(0)).cumsum(dim=2) * 0.1
    network = _tempered(controls)
    wild = 5.0 * controls[:1]
    made, scale = network.tempered(wild, wild)
    torch.testing.assert_close(made, wild, rtol=0, atol=0)
    assert (scale == 1).all() and network.tempered(wild)[1].min() < 0.5


def test_dragging_further_never_brings_the_face_back_and_moves_it_from_anywhere() -> None:
    rng = torch.Generator().manual_seed(0)
    network = _tempered(torch.randn(20, 3, 256, generator=rng).cumsum(dim=2) * 0.1)
    for begun in (0.2, 1.0, 6.0):  # well within what was recorded, and far beyond it
        original = begun * torch.randn(1, 3, 1, generator=rng).expand(1, 3, 64)
        ways = torch.randn(8, 3, 1, generator=rng)
        reached = []
        for amount in torch.linspace(0.0, 30.0, 61):
            made, _ = network.tempered(original + amount * ways, original.expand(8, 3, 64))
            reached.append(((made - original) / ways).mean(dim=1))
            torch.testing.assert_close(made, original + reached[-1][:, None] * ways)  # no other control moves
        steps = torch.stack(reached).diff(dim=0)
        assert steps.min() > -1e-4
        assert steps[0].min() > 0.1
