from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest
import torch

from engine.controls import measure
from engine.errors import AssetError
from engine.lab.corpus import Piece
from engine.lab.evaluate.baselines import NAMES, hsk16, parts
from engine.lab.evaluate.baselines.nearest import Nearest
from engine.lab.evaluate.baselines.ridge import Ridge
from engine.lab.performer.corpus import synthetic_performances
from engine.regress.areas import AREAS


def test_ridge_equals_the_augmented_least_squares_problem() -> None:
    rng = np.random.default_rng(0)
    controls, weights, penalty = rng.normal(size=(3, 4, 20)), rng.normal(size=(3, 5, 20)), 0.3
    ridge = Ridge(4, 5)
    ridge.solve(torch.tensor(controls).float(), torch.tensor(weights).float(), penalty)
    x, y = (array.transpose(0, 2, 1).reshape(60, -1) for array in (controls, weights))
    x = (x - x.mean(axis=0)) / x.std(axis=0, ddof=1)
    rows = np.concatenate([x, np.sqrt(penalty * len(x)) * np.eye(4)])
    slope = np.linalg.lstsq(rows, np.concatenate([y - y.mean(axis=0), np.zeros((4, 5))]), rcond=None)[0]
    with torch.inference_mode():
        made = ridge(torch.tensor(controls).float()).numpy().transpose(0, 2, 1).reshape(60, -1)
    np.testing.assert_allclose(made, x @ slope + y.mean(axis=0), atol=1e-4)


def test_nearest_finds_the_very_frames_it_was_given() -> None:
    weights = synthetic_performances(0.2, seed=1)[0]
    made = Nearest([Piece(weights, True, "someone")]).infer(measure(weights))
    columns = np.concatenate([area.shape_columns for area in AREAS])
    exact = np.abs(made - weights)[:, columns].max(axis=1) < 1e-9
    assert exact.mean() > 0.95  # the rest are frames at rest, which look alike


def test_a_saved_baseline_comes_back(tmp_path: Path) -> None:
    torch.manual_seed(0)
    modules = {area.name: hsk16.HSK16(len(area.controls), len(area.shape_columns), 7) for area in AREAS}
    parts.save("hsk16", modules, {area.name: {"width": 7} for area in AREAS}, tmp_path)
    again = parts.restore(
        "hsk16", lambda area, found: hsk16.HSK16(len(area.controls), len(area.shape_columns), found["width"]), tmp_path
    )
    controls = np.random.default_rng(0).uniform(0, 50, (33, 8))
    one, other = (parts.Areas(part, alignment=2).infer(controls) for part in (modules, again))
    np.testing.assert_array_equal(one, other)
    assert len(one) == 33


@pytest.mark.parametrize("name", NAMES)
def test_a_missing_baseline_says_how_to_train_it(name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    every = {"every": True} if name.endswith("_16") else {}
    module = importlib.import_module(f"engine.lab.evaluate.baselines.{name.removesuffix('_16')}")
    real = parts.restore
    monkeypatch.setattr(module, "restore", lambda name, build: real(name, build, tmp_path))
    with pytest.raises(AssetError, match="retake train regress_baselines"):
        module.load(**every)
