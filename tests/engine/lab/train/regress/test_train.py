from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from safetensors.torch import load_file

from engine.lab.corpus import split
from engine.lab.performer import demo
from engine.lab.performer.augment import Levers
from engine.lab.train.regress.train import Recipe, Settings, train, train_area
from engine.regress.areas import AREAS, EXTENDED_AREAS

ALL = (*AREAS, *EXTENDED_AREAS)

LEVERS = Levers(copies=1)
RECIPES = {area.name: Recipe((4, 4, 4), (2, 2), levers=LEVERS, synthetic_minutes=0.0) for area in ALL}
TINY = Settings(window=32, recipes=RECIPES)


@pytest.fixture
def recordings(tmp_path: Path) -> Path:
    (tmp_path / "takes").mkdir()
    shutil.copy(demo.BUNDLED, tmp_path / "takes" / "someone.csv")
    return tmp_path / "takes"


def _models(folder: Path) -> dict[str, dict[str, torch.Tensor]]:
    return {area.name: load_file(folder / f"regress_{area.name}.safetensors") for area in ALL}


def test_a_run_that_was_stopped_ends_as_one_that_was_not(recordings: Path, tmp_path: Path) -> None:
    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    figures = train(recordings, whole, TINY, report=lambda _: None)

    def stop_in(word: str):
        def report(line: str) -> None:
            if line.startswith(word):
                raise KeyboardInterrupt

        return report

    for moment in ("lower regressor 1/", "lower autoencoder 1/", "gaze autoencoder 2/"):
        with pytest.raises(KeyboardInterrupt):
            train(recordings, stopped, TINY, report=stop_in(moment))
        assert list(stopped.glob("*.partial.safetensors"))
    again = train(recordings, stopped, TINY, report=lambda _: None)
    assert not list(stopped.glob("*.partial.safetensors"))
    for area, terms in figures.items():
        assert again[area] == pytest.approx(terms, abs=1e-6)
    for area, tensors in _models(whole).items():
        for name, tensor in tensors.items():
            torch.testing.assert_close(_models(stopped)[area][name], tensor, atol=1e-6, rtol=0)


def test_other_settings_begin_anew(recordings: Path, tmp_path: Path) -> None:
    lines: list[str] = []

    def stop(line: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(recordings, tmp_path, TINY, report=stop)
    train(recordings, tmp_path, replace(TINY, seed=1), report=lines.append)
    assert not any("going on" in line for line in lines)


def test_the_same_seed_gives_the_same_figures_and_another_does_not(recordings: Path, tmp_path: Path) -> None:
    training, validation, _ = split(recordings)

    def figures(seed: int, name: str) -> dict[str, float]:
        settings = replace(TINY, seed=seed)
        return train_area(AREAS[2], training, validation, settings, path=tmp_path / name, report=lambda _: None)[1]

    once, again, other = figures(0, "once"), figures(0, "again"), figures(1, "other")
    assert once == pytest.approx(again, abs=1e-4)
    assert once != pytest.approx(other, abs=1e-4)
