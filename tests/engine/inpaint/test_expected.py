from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from engine.controls import CONTROL_INDEX, CONTROLS, FEW, measure
from engine.errors import AssetError
from engine.inpaint.expected import Expected, bundled, load
from engine.lab.train.inpaint import expected_train
from engine.lab.train.inpaint.expected_train import Settings, fitted, given_controls, joined
from engine.lab.train.inpaint.material import Performance, synthetic
from engine.models.checkpoint import save_model
from engine.take import SHAPE_INDEX, SHAPES, Array

SMALL = Settings(members=2, steps=25, frames=32, batch=8)


@pytest.fixture(scope="module")
def material() -> list[Performance]:
    return synthetic(0.3, np.random.default_rng(0))


@pytest.fixture(scope="module")
def members(material: list[Performance]) -> list[Expected]:
    torch.set_num_threads(1)
    return [fitted(material, SMALL, member, report=lambda line: None) for member in range(2)]


def only(curves: Array, *names: str) -> Array:
    return np.where(np.isin(list(CONTROL_INDEX), names), curves, np.nan)


def test_the_face_is_the_mean_of_what_each_member_says(members: list[Expected], material: list[Performance]) -> None:
    curves = torch.tensor(measure(material[0].weights[:40])[None], dtype=torch.float32)
    apart = torch.stack([member(curves) for member in members])
    assert (apart[0] - apart[1]).abs().max() > 1e-3
    torch.testing.assert_close(joined(members)(curves), apart.mean(dim=0))


def test_training_brings_the_error_below_that_of_the_mean_face(
    members: list[Expected], material: list[Performance]
) -> None:
    truth = material[0].weights
    off = (joined(members).face(measure(truth)) - truth) ** 2
    assert off.mean() < 0.7 * ((truth.mean(axis=0) - truth) ** 2).mean()


@pytest.mark.parametrize("frames", [1, 4, 7, 50])
def test_any_length_and_any_controls_give_a_face(frames: int) -> None:
    curves = measure(np.random.default_rng(0).random((frames, len(SHAPES))) * 0.3)
    for names in ((), ("eyelid_left",), FEW, tuple(CONTROL_INDEX)):
        face = bundled().face(only(curves, *names))
        assert face.shape == (frames, len(SHAPES)) and face.min() >= 0 and face.max() <= 1


def test_a_control_that_is_not_given_has_no_say() -> None:
    curves = measure(np.random.default_rng(0).random((40, len(SHAPES))) * 0.3)
    others = curves + np.where(np.isin(list(CONTROL_INDEX), FEW), 0.0, 5.0)
    np.testing.assert_array_equal(bundled().face(only(curves, *FEW)), bundled().face(only(others, *FEW)))
    assert np.abs(bundled().face(curves) - bundled().face(others)).max() > 0.01


def test_one_eyelid_that_shuts_shuts_both_eyes_and_leaves_the_jaw() -> None:
    rest = measure(np.zeros((60, len(SHAPES))))
    shut = rest.copy()
    shut[25:35, CONTROL_INDEX["eyelid_left"]] = 0.5
    moved = bundled().face(only(shut, *FEW))[30] - bundled().face(only(rest, *FEW))[30]
    assert moved[SHAPE_INDEX["eyeBlinkLeft"]] > 0.4 and moved[SHAPE_INDEX["eyeBlinkRight"]] > 0.4
    assert abs(moved[SHAPE_INDEX["jawOpen"]]) < 0.1


def test_windows_show_all_the_few_or_any_controls_and_some_break_off() -> None:
    shown = given_controls(2000, 32, Settings(), np.random.default_rng(0))
    ever = shown.any(axis=1)
    few = (ever == np.isin(list(CONTROL_INDEX), FEW)).all(axis=1).mean()
    assert ever.any(axis=1).mean() > 0.97  # a stretch without any may be the whole window
    assert ever.all(axis=1).mean() == pytest.approx(0.3, abs=0.05) and few == pytest.approx(0.2, abs=0.05)
    assert ((shown != shown[:, :1]).any(axis=(1, 2))).mean() == pytest.approx(0.25, abs=0.06)
    np.testing.assert_array_equal(shown[~shown.all(axis=2).any(axis=1)].any(axis=1).sum(axis=1) < len(CONTROLS), True)


def test_training_goes_on_after_the_last_whole_member(
    material: list[Performance], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(expected_train, "split", lambda data: ([], [], []))
    monkeypatch.setattr(expected_train, "performances", lambda *rest: material)
    monkeypatch.setattr(expected_train, "validation_errors", lambda *rest: {})
    quick = Settings(members=2, steps=3, frames=32, batch=4)
    whole, halves = tmp_path / "whole", tmp_path / "halves"
    expected_train.train(tmp_path, whole, quick, report=lambda line: None)
    once = fitted(material, quick, 0, report=lambda line: None)
    expected_train._save(halves / expected_train.PARTIAL, once, kind="expected-partial")
    expected_train.train(tmp_path, halves, quick, report=lambda line: None)
    curves = measure(material[0].weights[:40])
    one, other = (load(folder / "expected.safetensors").face(curves) for folder in (whole, halves))
    np.testing.assert_allclose(one, other, atol=1e-6)
    assert not (halves / expected_train.PARTIAL).exists() and (halves / "expected.card.json").exists()


def test_a_file_of_another_kind_is_refused(tmp_path: Path) -> None:
    save_model(tmp_path / "x.safetensors", {}, kind="clean", config={})
    with pytest.raises(AssetError, match="expected"):
        load(tmp_path / "x.safetensors")
