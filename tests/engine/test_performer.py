from __future__ import annotations

import numpy as np
import pytest

from engine.controls import measure
from engine.errors import EngineError
from engine.lab.performer import demo
from engine.lab.performer.performer import Script, perform


def test_the_same_script_gives_the_same_take() -> None:
    np.testing.assert_array_equal(perform(demo.SCRIPT).weights, perform(demo.SCRIPT).weights)


def test_the_bundled_demo_is_what_its_command_builds(tmp_path) -> None:
    demo.build(tmp_path / "demo.csv")
    assert (tmp_path / "demo.csv").read_bytes() == demo.BUNDLED.read_bytes()


def test_every_bilabial_closes_the_lips() -> None:
    take = perform(Script(phones=("SIL", "AA1", "B", "AA1", "M", "AA1", "P", "AA1", "SIL"), seed=1))
    lips = measure(take.weights)[:, 0]
    closures = np.diff(np.r_[0, (lips < 2.0).astype(int)]) == 1
    assert closures.sum() == 5  # the three bilabials and the rest on either side


def test_an_unknown_phone_is_named() -> None:
    with pytest.raises(EngineError, match="XX"):
        perform(Script(phones=("XX",)))
