from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import torch

from engine.lab.train.loop import Parts, Schedule, State, identity, train


@dataclass(frozen=True)
class Settings:
    seed: int = 0


class Walk:
    """A network of one layer that random targets pull about: every unit depends on all before it."""

    def __init__(self) -> None:
        torch.manual_seed(0)
        self.layer = torch.nn.Linear(3, 2)
        self.adam = torch.optim.Adam(self.layer.parameters(), lr=0.1)
        self.rng = np.random.default_rng(0)
        self.units: list[int] = []

    def advance(self, unit: int) -> dict[str, float]:
        self.units.append(unit)
        seen = torch.tensor(self.rng.random((4, 3)), dtype=torch.float32)
        loss = (torch.nn.functional.dropout(self.layer(seen)) - torch.rand(2)).square().mean()
        self.adam.zero_grad()
        loss.backward()
        self.adam.step()
        return {"mse": float(loss.detach())}

    def parts(self) -> Parts:
        return Parts({"layer": self.layer}, {"adam": self.adam}, {"rng": self.rng})

    def state(self) -> State:
        return State(self.parts().tensors(), {"so far": len(self.units)})

    def restore(self, state: State) -> None:
        self.parts().restore(state.tensors)


def schedule(folder: Path, **other: object) -> Schedule:
    run = identity(Settings(), [np.arange(3.0)])
    return replace(Schedule(10, folder / "part.safetensors", run, label=lambda done: f"walk {done}/10"), **other)


def stop_at(word: str) -> Callable[[str], None]:
    def report(line: str) -> None:
        if line.startswith(word):
            raise KeyboardInterrupt

    return report


def quiet(line: str) -> None:
    pass


@pytest.mark.parametrize(("every", "stop", "units"), [(1, 4, range(4, 10)), (3, 6, range(6, 10)), (3, 9, range(9, 10))])
def test_a_run_that_was_stopped_ends_as_one_that_was_not(tmp_path: Path, every: int, stop: int, units: range) -> None:
    second, first = Walk(), Walk()  # the last that is begun sets the random numbers
    with pytest.raises(KeyboardInterrupt):
        train(first, schedule(tmp_path, every=every), stop_at(f"walk {stop}/"))
    torch.manual_seed(7)
    train(second, schedule(tmp_path, every=every), quiet)
    assert second.units == list(units)
    assert all(
        torch.equal(one, other) for one, other in zip(second.layer.parameters(), fresh().parameters(), strict=True)
    )


def fresh() -> torch.nn.Linear:
    """Return the layer of a walk without stops."""
    walk = Walk()
    for unit in range(10):
        walk.advance(unit)
    return walk.layer


def test_a_checkpoint_of_other_settings_or_data_is_left_alone(tmp_path: Path) -> None:
    train(Walk(), schedule(tmp_path), quiet)
    for run in (identity(Settings(seed=1), [np.arange(3.0)]), identity(Settings(), [np.arange(4.0)])):
        walk = Walk()
        train(walk, schedule(tmp_path / "x", run=run, shared=tmp_path / "part.safetensors"), quiet)
        assert walk.units == list(range(10))


def test_a_damaged_checkpoint_begins_anew_and_says_so(tmp_path: Path) -> None:
    (tmp_path / "part.safetensors").write_bytes(b"half of a")
    lines: list[str] = []
    walk = Walk()
    train(walk, schedule(tmp_path), lines.append)
    assert walk.units == list(range(10)) and lines[0].endswith("The training begins anew.")


def test_the_first_units_are_shared_and_a_further_checkpoint_comes_first(tmp_path: Path) -> None:
    shared = {"shared": tmp_path / "shared.safetensors", "shared_units": 4}
    with pytest.raises(KeyboardInterrupt):
        train(Walk(), schedule(tmp_path, **shared), stop_at("walk 6/"))
    other, same = Walk(), Walk()
    train(other, schedule(tmp_path / "other", **shared), quiet)
    train(same, schedule(tmp_path, **shared), quiet)
    assert other.units == list(range(4, 10)) and same.units == list(range(6, 10))


def test_a_report_holds_the_means_since_the_last(tmp_path: Path) -> None:
    lines: list[str] = []

    class Counting(Walk):
        def advance(self, unit: int) -> dict[str, float]:
            return {"unit": float(unit)}

    train(Counting(), schedule(tmp_path, every=4), lines.append)
    assert [line.split(" (")[0] for line in lines] == [
        "walk 4/10: unit 1.50000",
        "walk 8/10: unit 5.50000",
        "walk 10/10: unit 8.50000",
    ]
