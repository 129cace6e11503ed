from __future__ import annotations

import numpy as np
import pytest
import torch

from engine.lab.performer.augment import Levers
from engine.lab.performer.corpus import synthetic_performances
from engine.lab.train.clean.batches import Settings
from engine.lab.train.clean.train import Trainer
from engine.take import Array

SMALL = Settings(
    epochs=4,
    batches=1,
    chunk=16,
    first_chunk=8,
    chunks=2,
    streams=3,
    dropout=0.2,
    synthetic_minutes=0.0,
    levers=Levers(copies=0),
)


@pytest.fixture(scope="module")
def pieces() -> list[Array]:
    return synthetic_performances(0.3, seed=0)


@pytest.mark.parametrize("stop", [1, 3])
def test_training_goes_on_exactly_where_it_stopped(pieces: list[Array], stop: int) -> None:
    whole = Trainer(pieces, pieces, SMALL)
    terms = [whole.advance(epoch) for epoch in range(SMALL.epochs)]
    first = Trainer(pieces, pieces, SMALL)
    for epoch in range(stop):
        first.advance(epoch)
    state = first.state()
    second = Trainer(pieces, pieces, SMALL)
    torch.manual_seed(99)
    second.restore(state)
    assert [second.advance(epoch) for epoch in range(stop, SMALL.epochs)] == terms[stop:]
    (one, figures), (other, again) = whole.best(), second.best()
    assert figures == again
    for name, value in one.state_dict().items():
        assert torch.equal(value, other.state_dict()[name]), name


def test_the_best_epoch_is_kept(pieces: list[Array]) -> None:
    trainer = Trainer(pieces, pieces, SMALL)
    before = trainer.validate()["mse"]
    seen = [trainer.advance(epoch)["mse"] for epoch in range(SMALL.epochs)]
    network, figures = trainer.best()
    assert figures["mse"] == min([before, *seen])
    trainer.network = network
    assert trainer.validate()["mse"] == pytest.approx(figures["mse"], rel=1e-6)
    assert np.isfinite(list(figures.values())).all()
