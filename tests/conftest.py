from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from engine.take import SHAPES, Take

ROOT = Path(__file__).parent.parent
DATA = Path(os.environ.get("RETAKE_DATA", ROOT.parent / "shared" / "data"))


@pytest.fixture(autouse=True)
def usual_scheduling() -> None:
    """Give the tests' own thread its usual turn: where sound was opened by root it may run ahead of all others."""
    if hasattr(os, "sched_getscheduler") and os.sched_getscheduler(0) != os.SCHED_OTHER:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


@pytest.fixture
def real_take_path() -> Path:
    path = DATA / "livelink" / "alex_rom_4.csv"
    if not path.exists():
        pytest.skip("needs the recorded takes: set RETAKE_DATA")
    return path


@pytest.fixture
def random_take() -> Take:
    rng = np.random.default_rng(3)
    return Take(weights=rng.random((40, len(SHAPES))), fps=30.0, name="random")
