"""The U-Net that is run by hand against one of torch's own modules, and what its linear part sees."""

from __future__ import annotations

import math

import pytest
import torch
from torch import Tensor
from torch.nn.functional import conv1d, max_pool1d

from engine.regress.unet import SHORT, UNet, UNetConfig, _convolved, _grown

NAN = float("nan")


def a_net(**more: int) -> UNet:
    torch.manual_seed(0)
    net = UNet(UNetConfig(3, 2, (4, 6, 8), **more)).eval()
    for parameter in net.parameters():
        torch.nn.init.normal_(parameter, std=0.3)
    net.mean.normal_()
    net.scale.uniform_(0.5, 2.0)
    return net


def curves(count: int, frames: int = 16, batch: int = 2) -> Tensor:
    return torch.randn(batch, count, frames, generator=torch.Generator().manual_seed(1))


def plain(net: UNet, seen: Tensor) -> Tensor:
    """The convolutions' part, with torch's own modules."""
    fine = net.down1(seen)
    half = net.down2(max_pool1d(fine, 2))
    deep = net.bottom(max_pool1d(half, 2))
    half = net.up2(torch.cat([deep.repeat_interleave(2, dim=2), half], dim=1))
    return net.last(net.up1(torch.cat([half.repeat_interleave(2, dim=2), fine], dim=1)))


@pytest.mark.parametrize("width", [1, 3])
@pytest.mark.parametrize("frames", [1, 5, SHORT // 2, SHORT // 2 + 1])
def test_a_convolution_is_torch_s_own_however_long(width: int, frames: int) -> None:
    x, kernel, bias = curves(4, frames), torch.randn(5, 4, width), torch.randn(5)
    torch.testing.assert_close(
        _convolved(x, kernel, bias), conv1d(x, kernel, bias, padding=width // 2), atol=1e-5, rtol=1e-5
    )


def test_every_frame_is_doubled() -> None:
    torch.testing.assert_close(_grown(curves(3)), curves(3).repeat_interleave(2, dim=2))


@pytest.mark.parametrize("frames", [8, 1024])
def test_the_net_is_its_linear_part_and_its_convolutions(frames: int) -> None:
    net, x = a_net(), curves(3, frames)
    with torch.inference_mode():
        seen = (x - net.mean) / net.scale
        torch.testing.assert_close(net(x), net.linear(seen) + plain(net, seen), atol=1e-4, rtol=1e-4)
        torch.testing.assert_close(net.straight(x), net.linear(seen), atol=1e-5, rtol=1e-5)


def test_a_new_net_is_its_linear_part_alone() -> None:
    net = UNet(UNetConfig(3, 2))
    with torch.inference_mode():
        torch.testing.assert_close(net(curves(3)), net.linear(curves(3)))


def test_waves_are_beside_the_inputs_and_as_strong() -> None:
    net, x = a_net(waves=400), torch.randn(1, 3, 200)
    seen = net.bent(x)
    assert seen.shape == (1, 403, 200)
    torch.testing.assert_close(seen[:, :3], x)
    expected = math.sqrt(2) * torch.cos(torch.einsum("wi,bif->bwf", net.turns[..., 0], x) + net.phases[:, None])
    torch.testing.assert_close(seen[:, 3:], expected, atol=1e-5, rtol=1e-5)
    assert seen[:, 3:].square().mean().item() == pytest.approx(1.0, abs=0.1)
    assert a_net().bent(x) is x


def test_inputs_that_are_not_given_are_at_their_mean_and_another_linear_map_counts_without_them() -> None:
    net, x = a_net(further=2), curves(5)
    x[:, 3, 4:7] = NAN
    x[:, 4, 6:9] = NAN
    given = torch.ones(2, 1, 16)
    given[:, :, 4:9] = 0.0
    seen = (x - net.mean) / net.scale
    seen = torch.cat([seen[:, :3], torch.where(given > 0, seen[:, 3:], 0.0), given], dim=1)
    with torch.inference_mode():
        assert net.more is not None
        straight = torch.where(given > 0, net.more(seen[:, :5]), net.linear(seen[:, :3]))
        torch.testing.assert_close(net(x), straight + plain(net, seen), atol=1e-4, rtol=1e-4)
        torch.testing.assert_close(net.straight(x), straight, atol=1e-5, rtol=1e-5)


def test_further_inputs_left_out_are_the_same_as_not_given_and_all_given_need_no_choice() -> None:
    net, x = a_net(further=2, waves=7), curves(5)
    nothing = x.clone()
    nothing[:, 3:] = NAN
    with torch.inference_mode():
        torch.testing.assert_close(net(x[:, :3]), net(nothing), atol=1e-5, rtol=1e-5)
        assert net.more is not None
        seen = (x - net.mean) / net.scale
        torch.testing.assert_close(net.straight(x), net.more(net.bent(seen)), atol=1e-5, rtol=1e-5)
    assert net.config.channels == 6 and UNetConfig(3, 2).channels == 3
