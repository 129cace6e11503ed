from __future__ import annotations

import numpy as np
import torch

from engine.lab.performer.augment import Levers
from engine.lab.performer.corpus import synthetic_performances
from engine.lab.train.regress.data import OUTWEIGH, Source, Windows
from engine.lab.train.regress.start import begin, without_further
from engine.regress.areas import Area
from engine.regress.network import network_of

AREA = Area("lids", ("eyelid_right", "eyelid_left"), ("eyeBlink",), True, ("gaze_vertical",))


def _person(turn: float, rng: torch.Generator) -> Windows:
    """Someone whose lids follow the first control alike, and the second in a way of their own."""
    controls = torch.randn(12, 16, 64, generator=rng)
    weights = torch.zeros(12, 52, 64)
    weights[:, AREA.shape_columns] = 0.5 + 0.1 * controls[:, 2:3] + turn * controls[:, 3:4]
    return Windows(controls, weights)


def test_the_penalty_is_that_which_serves_people_left_out() -> None:
    rng = torch.Generator().manual_seed(0)
    for turns, best in (((0.0, 0.0, 0.0), 1e-4), ((0.3, -0.3, 0.3), 3.0)):
        people = [_person(turn, rng) for turn in turns]
        found = begin(network_of(AREA, widths=(4, 4, 4)), AREA, people[0], people, (1e-4, 3.0))
        assert min(found, key=lambda penalty: found[penalty]) == best


def test_further_controls_have_a_linear_part_of_their_own() -> None:
    rng = torch.Generator().manual_seed(0)
    person = _person(0.0, rng)
    person.weights[:, AREA.shape_columns] += 0.2 * person.controls[:, 13:14]
    network = network_of(AREA, widths=(4, 4, 4))
    begin(network, AREA, person, [person], (1e-6,))
    truth, seen = person.weights[:, AREA.shape_columns], person.controls[:, AREA.every_column]
    given, without = (network(one, full=False) for one in (seen, without_further(seen, 2)))
    assert (given - truth).square().mean() < 1e-6
    assert (without - truth).square().mean() > 0.02
    torch.testing.assert_close(network(seen[:, :2], full=False), without)


def test_nobody_outweighs_the_others() -> None:
    short = synthetic_performances(0.2, seed=1)[0]
    pieces = (short, short, *[short] * 20)
    source = Source(pieces, ("one", "two", *["many"] * 20), (), Levers(copies=0), seed=0, window=64)
    drawn = source._drawn(np.random.default_rng(0))
    assert len(drawn) == 2 + np.ceil(OUTWEIGH)
