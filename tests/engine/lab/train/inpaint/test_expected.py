from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from engine.controls import CONTROL_INDEX, CONTROLS, FEW, measure
from engine.inpaint.expected import load
from engine.lab.train.inpaint import expected
from engine.lab.train.inpaint.expected import Settings, Trainer, fitted, given_controls
from engine.lab.train.inpaint.material import Performance, synthetic

SMALL = Settings(members=2, steps=25, frames=32, batch=8)
QUICK = replace(SMALL, steps=3, batch=4)


@pytest.fixture(scope="module")
def material() -> list[Performance]:
    return synthetic(0.3, np.random.default_rng(0))


def test_training_brings_the_error_below_that_of_the_mean_face(material: list[Performance], tmp_path: Path) -> None:
    network = fitted(material, SMALL, tmp_path / "part.safetensors", report=lambda line: None)
    truth = material[0].weights
    off = (network.pose(measure(truth)) - truth) ** 2
    assert off.mean() < 0.7 * ((truth.mean(axis=0) - truth) ** 2).mean()


def test_windows_show_all_the_few_or_any_controls_and_some_break_off() -> None:
    shown = given_controls(2000, 32, Settings(), np.random.default_rng(0))
    ever = shown.any(axis=1)
    few = (ever == np.isin(list(CONTROL_INDEX), FEW)).all(axis=1).mean()
    assert ever.any(axis=1).mean() > 0.97  # a stretch without any may be the whole window
    assert ever.all(axis=1).mean() == pytest.approx(0.3, abs=0.05) and few == pytest.approx(0.2, abs=0.05)
    assert ((shown != shown[:, :1]).any(axis=(1, 2))).mean() == pytest.approx(0.25, abs=0.06)
    np.testing.assert_array_equal(shown[~shown.all(axis=2).any(axis=1)].any(axis=1).sum(axis=1) < len(CONTROLS), True)


@pytest.mark.parametrize("stop", [1, 3, 4])
def test_training_goes_on_exactly_where_it_stopped(material: list[Performance], stop: int) -> None:
    whole, first, second = (Trainer(material, QUICK) for _ in range(3))
    torch.manual_seed(QUICK.seed)
    for step in range(6):
        whole.advance(step)
    for step in range(stop):
        first.advance(step)
    state = first.state()
    torch.manual_seed(99)
    second.restore(state)
    for step in range(stop, 6):
        second.advance(step)
    for name, value in whole.trained().state_dict().items():
        assert torch.equal(value, second.trained().state_dict()[name]), name


def test_what_is_trained_is_written_with_its_card_and_no_checkpoint_is_left(
    material: list[Performance], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(expected, "split", lambda data: ([], [], []))
    monkeypatch.setattr(expected, "performances", lambda *rest: material)
    monkeypatch.setattr(expected, "validation_errors", lambda *rest: {})
    expected.train(tmp_path, tmp_path, QUICK, report=lambda line: None)
    again = fitted(material, QUICK, tmp_path / "part.safetensors", report=lambda line: None)
    curves = measure(material[0].weights[:40])
    np.testing.assert_array_equal(load(tmp_path / "expected.safetensors").pose(curves), again.pose(curves))
    assert not (tmp_path / expected.PARTIAL).exists() and (tmp_path / "expected.card.json").exists()
