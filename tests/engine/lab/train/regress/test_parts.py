from __future__ import annotations

import numpy as np
import torch

from engine.controls import measure
from engine.lab.performer.augment import Levers
from engine.lab.performer.corpus import synthetic_performances
from engine.lab.train.regress.data import NearestFaces, Source, cut
from engine.lab.train.regress.losses import distance_error
from engine.lab.train.regress.requests import contradictory, exaggerated, salt_and_pepper
from engine.regress.areas import AREAS


def test_a_closure_invented_weighs_like_one_missed() -> None:
    shut, apart = torch.zeros(1, 1, 4), torch.full((1, 1, 4), 9.0)
    missed, invented = distance_error(apart, shut, 4.0), distance_error(shut, apart, 4.0)
    assert missed == invented == 5 * 81.0
    assert distance_error(apart, apart + 9, 4.0) < 1.01 * 81.0


def test_the_same_epoch_gives_the_same_windows_and_another_gives_others() -> None:
    source = Source(tuple(synthetic_performances(0.2, seed=1)), ("someone",), (), Levers(copies=2), seed=0, window=64)
    one, same, other = source.epoch(1, 4), source.epoch(1, 4), source.epoch(1, 5)
    assert torch.equal(one.weights, same.weights) and torch.equal(one.controls, same.controls)
    assert not torch.equal(one.weights[:2], other.weights[:2])


def test_controls_of_windows_are_those_measured() -> None:
    made = cut(synthetic_performances(0.2, seed=1), length=64, overlap=0.5)
    np.testing.assert_allclose(made.controls[3, :8].T, measure(made.weights[3].numpy().T.astype(float)), atol=1e-4)


def test_a_face_that_exists_is_its_own_nearest() -> None:
    area = AREAS[0]
    windows = cut(synthetic_performances(0.2, seed=1), length=64, overlap=0.0)
    columns, shapes = torch.tensor(area.control_columns), torch.tensor(area.shape_columns)
    nearest = NearestFaces(windows, columns, shapes, seed=0)
    found = nearest.weights(windows.controls[:, columns])
    assert (found - windows.weights[:, shapes]).square().mean() < 2e-3
    beyond = nearest.weights(windows.controls[:, columns] * 10)
    assert beyond.min() >= 0 and beyond.max() <= windows.weights.max()


def test_salt_and_pepper_throws_the_share_it_is_asked_to() -> None:
    controls, low, high = torch.full((50, 3, 64), 5.0), torch.zeros(1, 3, 1), torch.full((1, 3, 1), 9.0)
    thrown = salt_and_pepper(controls, low, high, 0.2, torch.Generator().manual_seed(0))
    assert set(thrown.unique().tolist()) == {0.0, 5.0, 9.0}
    assert abs((thrown != 5.0).float().mean() - 0.2) < 0.02


def test_exaggeration_scales_departures_from_rest() -> None:
    rest = torch.tensor([[[2.0], [-1.0]]])
    controls = rest + torch.tensor([[[1.0, -1.0], [0.0, 3.0]]])
    torch.testing.assert_close(exaggerated(controls, rest, 2.0) - rest, 2 * (controls - rest))


def test_contradictions_keep_some_controls_and_exchange_others() -> None:
    controls = torch.arange(40.0).reshape(40, 1, 1).expand(40, 6, 8)
    mixed = contradictory(controls, torch.Generator().manual_seed(0))
    kept = (mixed == controls).all(dim=2).sum(dim=1)
    changed = kept < 6
    assert changed.float().mean() > 0.9  # a window may draw itself as the other
    assert (kept[changed] >= 1).all()
