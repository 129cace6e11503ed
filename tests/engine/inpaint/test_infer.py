from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from safetensors import safe_open
from safetensors.torch import load_file, save_file

from engine.errors import AssetError
from engine.inpaint import infer
from engine.inpaint.gap import Gap, gap_of
from engine.inpaint.infer import TUNING, Filler, bundled, load, save_filler
from engine.lab.performer import demo
from engine.lab.performer.performer import perform

SPAN = slice(60, 180)
MIDDLE = slice(90, 150)


@pytest.fixture(scope="module")
def gap() -> Gap:
    known = perform(replace(demo.SCRIPT, lost_s=())).weights[:240].copy()
    known[SPAN] = np.nan
    return gap_of(known)


def test_what_is_known_stays_and_the_rest_is_a_face(gap: Gap) -> None:
    found = bundled().fill(gap, seeds=(0, 5))
    there = np.isfinite(gap.known)
    assert found.shape == (2, *gap.known.shape) and found.dtype == np.float64
    for each in found:
        np.testing.assert_array_equal(each[there], gap.known[there])
        assert each.min() >= 0 and each.max() <= 1
    assert np.abs(np.diff(found, axis=1))[:, SPAN.start - 1 : SPAN.stop + 1].max() < 0.2


def test_a_seed_gives_the_same_motion_whatever_is_filled_with_it(gap: Gap) -> None:
    together, alone = bundled().fill(gap, seeds=(3, 1, 3)), bundled().fill(gap, seeds=(3,))
    np.testing.assert_array_equal(together[0], together[2])
    np.testing.assert_allclose(together[0], alone[0], atol=1e-5)  # networks round by how many they make at once
    assert np.abs(together[0] - together[1])[MIDDLE].mean() > 1e-3
    np.testing.assert_array_equal(bundled().fill(gap), bundled().fill(gap, seeds=[0]))


def test_variants_lie_farther_apart_the_livelier_they_are(gap: Gap, monkeypatch: pytest.MonkeyPatch) -> None:
    def apart() -> float:
        return float(bundled().fill(gap, seeds=range(4))[:, MIDDLE].std(axis=0).mean())

    usual = apart()
    monkeypatch.setattr(infer, "LIVELINESS", 1.0)
    assert 1.5 < usual / apart() < 3.5


def test_what_is_pulled_below_nought_ends_near_it_and_keeps_moving() -> None:
    weights = np.linspace(-1.0, 1.0, 201)
    found = infer._soft_clip(weights)
    np.testing.assert_allclose(
        found * (found - weights), TUNING.soft_clip**2 / 4, atol=1e-12
    )  # a hyperbola along both lines
    assert (found > np.maximum(weights, 0)).all() and (np.diff(found) > 0).all()
    assert found[100] == TUNING.soft_clip / 2 and found[-1] == pytest.approx(1.0, abs=TUNING.soft_clip**2)


def test_a_filler_that_was_stored_fills_alike(gap: Gap, tmp_path: Path) -> None:
    path = tmp_path / "stored.safetensors"
    save_filler(path, bundled())
    again = load(path)
    assert isinstance(again, Filler) and not again.generator.training
    np.testing.assert_array_equal(again.fill(gap), bundled().fill(gap))


def test_a_model_without_its_statistics_is_one_sentence(tmp_path: Path) -> None:
    path = tmp_path / "inpaint.safetensors"
    save_filler(path, bundled())
    with safe_open(path, "pt") as opened:
        about = opened.metadata()
    for name in ("mean", "cross"):
        tensors = load_file(path)
        del tensors[f"statistics.{name}"]
        poor = tmp_path / f"without_{name}.safetensors"
        save_file(tensors, poor, about)
        with pytest.raises(AssetError, match="lacks its statistics"):
            load(poor)
    with pytest.raises(AssetError):
        load(tmp_path / "none.safetensors")
