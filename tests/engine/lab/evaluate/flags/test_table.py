from __future__ import annotations

import numpy as np
import pytest

from engine.formats import read_take
from engine.lab.evaluate.flags import table as flags
from engine.lab.evaluate.flags.planting import Planted
from engine.lab.evaluate.flags.plants import PLANTS
from engine.lab.performer import demo
from engine.quality import KINDS, Flag, flags_of
from engine.quality.seen import Sound
from engine.take import Take

SEED = 0


def source() -> flags.Source:
    """The demo, repeated to 72 s, with its lost frames filled in, and as loud as its jaw is open."""
    take = read_take(demo.BUNDLED)
    weights = np.tile(take.weights, (-(-2160 // len(take)), 1))[:2160]
    frames = np.arange(len(weights))
    turning = np.radians(5 * np.sin(frames / 40))[:, None] * np.ones(3)
    loud = np.convolve(weights[:, 17], np.ones(5) / 5, "same")
    return flags.Source("demo", Take(weights=weights, fps=take.fps), turning, Sound(loud, len(weights) / take.fps))


def test_every_kind_has_a_plant() -> None:
    assert set(PLANTS) == set(KINDS)


@pytest.mark.parametrize(
    "kind", ["spike", "frozen", "jitter", "pop", "head", "range", "close", "seam", "lost", "short", "unlike"]
)
def test_a_fault_is_planted_where_it_is_told_and_changes_nothing_elsewhere(kind: str) -> None:
    rng = np.random.default_rng(SEED)
    seen, found = flags._cut(source(), 300, 660), 0
    plants = [plant for plant in (PLANTS[kind](seen, rng) for _ in range(12)) if plant is not None]
    for plant in plants:
        assert 0 <= plant.start < plant.stop <= plant.seen.length
        away = np.ones(plant.seen.length, bool)
        away[plant.start : plant.stop] = False
        if kind != "seam":  # which also lays an eased edit beside the hard one
            assert (plant.seen.weights[away] == seen.weights[: plant.seen.length][away]).all()
        found += any(
            flag.kind == kind and flag.stop > plant.start - 3 for flag in flags_of(plant.seen, flags.EVERY_KIND)
        )
    least = 0.1 if kind == "unlike" else 0.6  # the demo says little that can be overdone
    assert found > least * len(plants) > 0


def test_a_flag_is_found_right_or_wrong_by_where_it_lies(monkeypatch: pytest.MonkeyPatch) -> None:
    plant = Planted(flags._cut(source(), 0, 60), 20, 30)
    made = [Flag("spike", 25, 26, 1.0, ""), Flag("pop", 22, 23, 1.0, ""), Flag("spike", 50, 51, 1.0, "")]
    monkeypatch.setattr(flags, "_sources", lambda data: [])
    monkeypatch.setattr(
        flags, "_planted", lambda kind, sources: [(plant.seen, plant, "demo")] if kind == "spike" else []
    )
    monkeypatch.setattr(flags, "flags_of", lambda seen, settings: made)
    rows = {row["kind"]: row for row in flags.table(None, lambda sentence: None)}
    spike, pop = rows["spike"], rows["pop"]
    assert (spike["planted"], spike["found"], spike["right"], spike["wrong"]) == (1, 1, 1, 1)
    assert (pop["planted"], pop["right"], pop["wrong"], pop["recall"]) == (0, 0, 0, None)
    assert spike["precision"] == 0.5 and 0 < spike["precision_low"] < 0.5 < spike["precision_high"] < 1


def test_takes_without_plants_tell_false_flags_a_minute() -> None:
    clean, spoilt = source(), source()
    weights = spoilt.take.weights.copy()
    weights[1000, 17] += 2.0
    spoilt = flags.Source("spoilt", spoilt.take.with_weights(weights), spoilt.rotations, spoilt.sound)
    found = flags._unplanted([clean, spoilt])
    first, second, both = found.rows
    assert second["flags"] > first["flags"] and both["flags"] == first["flags"] + second["flags"]
    assert both["flags_per_min_low"] < both["flags_per_min"] < both["flags_per_min_high"]
    assert "range 1" in second["kinds"] and found.counts["range"] == 1
    assert both["flags"] == found.counts.total()
