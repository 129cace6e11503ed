from __future__ import annotations

import numpy as np
import pytest
import torch

from engine.regress.areas import AREAS, EXTENDED_AREAS
from engine.regress.infer import Regressor
from engine.regress.network import network_of
from engine.take import SHAPES


@pytest.fixture
def regressor() -> Regressor:
    """Networks with random weights everywhere, so that every path through them counts."""
    torch.manual_seed(4)
    networks = {}
    for area in (*AREAS, *EXTENDED_AREAS):
        inputs = len(area.every_column)
        network = network_of(area, widths=(32, 64, 128))
        for unet in (network.regressor, network.autoencoder):
            torch.nn.init.normal_(unet.last.weight, std=0.3)
        network.regressor.scale.fill_(20.0)
        network.learn_bounds(torch.rand(8, inputs, 64) * 30, 0.05)
        networks[area.name] = network
    return Regressor(networks)


@pytest.mark.parametrize("controls", [8, 16])
@pytest.mark.parametrize("full", [True, False])
@pytest.mark.parametrize(("start", "stop"), [(0, 5), (100, 101), (97, 160), (233, 251), (0, 251)])
def test_a_range_equals_the_whole_take(regressor: Regressor, start: int, stop: int, full: bool, controls: int) -> None:
    curves = np.random.default_rng(1).uniform(0, 50, (251, controls))
    original = np.random.default_rng(2).uniform(0, 50, curves.shape)
    for known in (None, original):
        whole = regressor.infer(curves, full=full, original=known)[start:stop]
        made = regressor.infer_range(curves, start, stop, full=full, original=known)
        np.testing.assert_allclose(made, whole, atol=1e-5)
        assert np.ptp(whole) > 0.01


def test_the_lids_leave_gaze_alone(regressor: Regressor) -> None:
    controls = np.random.default_rng(2).uniform(0, 50, (40, 8))
    gaze = [index for index, name in enumerate(SHAPES) if name.startswith("eyeLook")]
    np.testing.assert_array_equal(regressor.infer(controls)[:, gaze], 0.0)


def test_extended_controls_tell_every_area_more(regressor: Regressor) -> None:
    controls = np.random.default_rng(3).uniform(0, 50, (40, 16))
    without, given = (regressor.infer(one, full=False) for one in (controls[:, :8], controls))
    changed = np.abs(given - without).max(axis=0) > 1e-3
    for area in (*AREAS, EXTENDED_AREAS[2]):
        assert changed[area.shape_columns].mean() > 0.5, area.name


def test_where_the_eyes_look_is_known_of_the_take_that_is_kept(regressor: Regressor) -> None:
    controls = np.random.default_rng(4).uniform(0, 50, (40, 8))
    kept = np.zeros((40, len(SHAPES)))
    kept[:, [SHAPES.index(f"eyeLookDown{side}") for side in ("Left", "Right")]] = 0.8
    ahead, down = (regressor.infer(controls, kept=one) for one in (np.zeros_like(kept), kept))
    lids = AREAS[2].shape_columns
    assert np.abs(ahead[:, lids] - down[:, lids]).max() > 0.01
    np.testing.assert_array_equal(down[:, kept[0] > 0], 0.8)
