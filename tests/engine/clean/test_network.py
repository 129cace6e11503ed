from __future__ import annotations

import numpy as np
import pytest
import torch

from engine.clean.infer import Cleaner
from engine.clean.network import CleanConfig, CleanNetwork, config_of, from_config, run
from engine.take import SHAPES

RNG = np.random.default_rng(0)
SEEN = RNG.random((90, len(SHAPES))).astype(np.float32)
PRESENT = (RNG.random((90, 1)) > 0.1).astype(np.float32)
STEPS = RNG.uniform(1 / 120, 1 / 24, (90, 1)).astype(np.float32)


def lively(layers: int = 1, seed: int = 0) -> CleanNetwork:
    """A network whose every part matters, without training it."""
    torch.manual_seed(seed)
    network = CleanNetwork(CleanConfig(hidden=32, layers=layers)).eval()
    for layer in (network.leave, network.restore):
        torch.nn.init.normal_(layer.weight, std=0.1)
    return network


def batch(*arrays: np.ndarray) -> list[torch.Tensor]:
    return [torch.tensor(array)[None] for array in arrays]


@pytest.mark.parametrize("layers", [1, 2])
def test_the_numpy_step_equals_torch(layers: int) -> None:
    network = lively(layers)
    with torch.inference_mode():
        expected, _ = run(network, *batch(SEEN, PRESENT, STEPS), network.start(torch.tensor(SEEN[:1])))
    cleaner = Cleaner(network)
    state = cleaner.start(SEEN[0])
    for seen, present, step, wanted in zip(SEEN, PRESENT, STEPS, expected[0].numpy(), strict=True):
        state = cleaner.step(seen if present[0] else None, float(step[0]), state)
        np.testing.assert_allclose(state.weights, wanted, atol=1e-5)


def test_a_stream_cut_in_two_gives_what_the_whole_gives() -> None:
    network = lively()
    whole, _ = run(network, *batch(SEEN, PRESENT, STEPS), network.start(torch.tensor(SEEN[:1])))
    first, state = run(network, *batch(SEEN[:40], PRESENT[:40], STEPS[:40]), network.start(torch.tensor(SEEN[:1])))
    second, _ = run(network, *batch(SEEN[40:], PRESENT[40:], STEPS[40:]), state)
    torch.testing.assert_close(torch.cat([first, second], dim=1), whole)


def test_the_future_does_not_matter() -> None:
    network = lively()
    changed = SEEN.copy()
    changed[50:] = 0.0
    one, other = (
        run(network, *batch(x, PRESENT, STEPS), network.start(torch.tensor(x[:1])))[0] for x in (SEEN, changed)
    )
    torch.testing.assert_close(one[:, :50], other[:, :50])


def test_what_is_not_present_has_no_effect() -> None:
    network = lively()
    changed = np.where(PRESENT > 0, SEEN, 0.7).astype(np.float32)
    start = network.start(torch.tensor(SEEN[:1]))
    one, other = (run(network, *batch(x, PRESENT, STEPS), start)[0] for x in (SEEN, changed))
    torch.testing.assert_close(one, other)


def test_an_untrained_network_follows_its_input_at_any_rate() -> None:
    network = CleanNetwork(CleanConfig())
    held = torch.tensor(SEEN[:1])[:, None].expand(1, 60, -1)
    for fps in (24.0, 120.0):
        ones = torch.ones(1, 60, 1)
        made, _ = run(network, held, ones, ones / fps, network.start(torch.zeros(1, len(SHAPES))))
        torch.testing.assert_close(made[:, -1], held[:, 0], atol=1e-4, rtol=0)


def test_a_network_is_rebuilt_from_its_configuration() -> None:
    network = lively(2)
    again = from_config(config_of(network))
    again.load_state_dict(network.state_dict())
    assert again.config == network.config
