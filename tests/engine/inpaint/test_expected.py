from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from engine.controls import CONTROL_INDEX, FEW, measure
from engine.errors import AssetError
from engine.inpaint.expected import Expected, bundled, load
from engine.lab.train.inpaint.expected import Settings, Trainer, joined
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
    trainer = Trainer(material, SMALL)
    for step in range(2 * SMALL.steps):
        trainer.advance(step)
    whole = trainer.trained()
    return [alone(whole, index) for index in range(2)]


def alone(network: Expected, member: int) -> Expected:
    """Return a network of one member of another."""
    tensors = {k: v for k, v in network.state_dict().items() if not k.startswith("members.")}
    prefix = f"members.{member}."
    tensors |= {
        f"members.0.{k.removeprefix(prefix)}": v for k, v in network.state_dict().items() if k.startswith(prefix)
    }
    made = Expected(members=1)
    made.load_state_dict(tensors)
    return made.eval()


def only(curves: Array, *names: str) -> Array:
    return np.where(np.isin(list(CONTROL_INDEX), names), curves, np.nan)


def test_the_face_is_the_mean_of_what_each_member_says(members: list[Expected], material: list[Performance]) -> None:
    curves = torch.tensor(measure(material[0].weights[:40])[None], dtype=torch.float32)
    apart = torch.stack([member(curves) for member in members])
    assert (apart[0] - apart[1]).abs().max() > 1e-3
    torch.testing.assert_close(joined(members)(curves), apart.mean(dim=0))


@pytest.mark.parametrize("frames", [1, 4, 7, 50])
def test_any_length_and_any_controls_give_a_face(frames: int) -> None:
    curves = measure(np.random.default_rng(0).random((frames, len(SHAPES))) * 0.3)
    for names in ((), ("eyelid_left",), FEW, tuple(CONTROL_INDEX)):
        face = bundled().pose(only(curves, *names))
        assert face.shape == (frames, len(SHAPES)) and face.min() >= 0 and face.max() <= 1


def test_a_control_that_is_not_given_has_no_say() -> None:
    curves = measure(np.random.default_rng(0).random((40, len(SHAPES))) * 0.3)
    others = curves + np.where(np.isin(list(CONTROL_INDEX), FEW), 0.0, 5.0)
    np.testing.assert_array_equal(bundled().pose(only(curves, *FEW)), bundled().pose(only(others, *FEW)))
    assert np.abs(bundled().pose(curves) - bundled().pose(others)).max() > 0.01


def test_one_eyelid_that_shuts_shuts_both_eyes_and_leaves_the_jaw() -> None:
    rest = measure(np.zeros((60, len(SHAPES))))
    shut = rest.copy()
    shut[25:35, CONTROL_INDEX["eyelid_left"]] = 0.5
    moved = bundled().pose(only(shut, *FEW))[30] - bundled().pose(only(rest, *FEW))[30]
    assert moved[SHAPE_INDEX["eyeBlinkLeft"]] > 0.4 and moved[SHAPE_INDEX["eyeBlinkRight"]] > 0.4
    assert abs(moved[SHAPE_INDEX["jawOpen"]]) < 0.1


def test_a_file_of_another_kind_is_refused(tmp_path: Path) -> None:
    save_model(tmp_path / "x.safetensors", {}, kind="clean", config={})
    with pytest.raises(AssetError, match="expected"):
        load(tmp_path / "x.safetensors")
