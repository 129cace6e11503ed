from __future__ import annotations

import re
from dataclasses import fields, replace

import numpy as np
import pytest

from engine.quality import (
    KINDS,
    TABLE,
    Kind,
    Seen,
)
from engine.quality.tracker import jitter_block
from tests.engine.quality.takes import (
    looked,
    still,
    troubled,
)


def test_a_kind_tells_its_name_its_threshold_and_its_reach() -> None:
    assert len({kind.name for kind in TABLE}) == len(TABLE) == len(KINDS)
    for kind in TABLE:
        assert kind.title and kind.threshold
        assert kind.reach is None or kind.reach(looked(still())) >= 1


def cropped(seen: Seen, first: int, last: int) -> Seen:
    part = {
        field.name: value[first:last]
        for field in fields(seen)
        if isinstance(value := getattr(seen, field.name), np.ndarray)
    }
    return replace(seen, **part)


@pytest.mark.parametrize("kind", [kind for kind in TABLE if kind.reach is not None], ids=lambda kind: kind.name)
def test_a_verdict_needs_no_frame_beyond_its_reach(kind: Kind) -> None:
    assert kind.reach is not None
    for seed in range(3):
        seen = troubled(seed)
        reach = kind.reach(seen)
        block = jitter_block(seen) if kind.name == "jitter" else 1
        for low, high in ((90, 150), (200, 201), (305, 391)):
            first = (low - reach) // block * block
            last = min(seen.length, -(-(high + reach) // block) * block)
            alone = list(kind.find(cropped(seen, first, last), low - first, high - first))
            there = [
                replace(flag, start=flag.start - first, stop=flag.stop - first) for flag in kind.find(seen, low, high)
            ]
            assert alone == there, (seed, low, high)


def test_every_kind_but_one_is_looked_for_by_itself_and_says_its_threshold_with_a_number() -> None:
    assert {kind.name for kind in TABLE if not kind.on} == {"unlike"}
    assert all(re.search(r"\d", kind.threshold) for kind in TABLE if kind.name not in ("lost",))
    assert {kind.name for kind in TABLE if kind.reach is None} == {
        *("swapped", "open", "teeth", "unclosed", "unblinking", "short", "sound")
    }
