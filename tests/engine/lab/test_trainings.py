from __future__ import annotations

from pathlib import Path

import pytest

from engine.errors import EngineError
from engine.lab import trainings
from engine.lab.trainings import TRAININGS, named


def test_each_name_finds_its_training_and_another_none() -> None:
    assert [named(training.name) for training in TRAININGS] == list(TRAININGS)
    with pytest.raises(EngineError, match="no network called 'regres'"):
        named("regres")


MODULES = {
    "regress_study": "study",
    "motion": "latent",
    "prior": "prior_train",
}


@pytest.mark.parametrize("name", [training.name for training in TRAININGS])
def test_a_name_trains_its_own_network(name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    heard: list[object] = []
    module = getattr(trainings, MODULES.get(name, name))
    monkeypatch.setattr(module, "train", lambda data, out, report: heard.extend([data, out, report]))
    named(name).train(tmp_path / "takes", tmp_path, print)
    assert heard == [tmp_path / "takes", tmp_path, print]
