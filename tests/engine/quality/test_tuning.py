from __future__ import annotations

import re

import numpy as np
import pytest

from engine.quality import TUNING, flags_of
from engine.quality.record import LEAST
from tests.engine.quality.takes import looked, still, troubled

# What a flag's sentence says of its amount: a pattern, the threshold and the full amount.
AMOUNTS = {
    "spike": (r"leaps by (\S+) for", TUNING.leap, TUNING.full_leap),
    "jitter": (r"trembles by (\S+) from", TUNING.jitter, TUNING.full_jitter),
    "pop": (r"steps by (\S+) from one", TUNING.pop, TUNING.full_pop),
    "head": (r"jumps by (\S+) degrees", TUNING.jump_deg, TUNING.full_jump_deg),
    "open": (r"stay (\S+) mm", TUNING.closed_mm, TUNING.full_gap_mm),
    "teeth": (r"stay (\S+) mm", TUNING.teeth_mm, TUNING.full_teeth_mm),
    "close": (r"is (\S+) above", TUNING.above_jaw, TUNING.full_above_jaw),
    "unclosed": (r"lids (\S+) mm", TUNING.unclosed_mm, TUNING.full_unclosed_mm),
    "late": (r"blinks (\S+) s after", TUNING.late_s, TUNING.full_late_s),
    "lost": (r"\((\S+) s\)", 0.0, TUNING.full_loss_s),
    "impossible": (r"both at (\S+) or", TUNING.both, 1.0),
    "through": (r"by (\S+) mm on", None, TUNING.full_through_mm),
    "seam": (r"steps by (\S+) at", TUNING.seam, TUNING.full_seam),
}


def test_what_each_sentence_says_of_its_amount_is_what_the_flag_weighs() -> None:
    seen: set[str] = set()
    for flag in (flag for seed in range(8) for flag in flags_of(troubled(seed))):
        pattern, least, full = AMOUNTS.get(flag.kind, ("$^", 0.0, 1.0))
        if told := re.search(pattern, flag.sentence):
            if least is None:
                least = TUNING.through_lips_mm if "lips" in flag.sentence else TUNING.through_lids_mm
            if flag.kind == "impossible" and "mouthStretch are" in flag.sentence:
                least = TUNING.both_wide
            rounding = 0.5 * 10.0 ** -len(told[1].partition(".")[2]) * 0.8 / (full - least) + 1e-9
            expected = min(1.0, LEAST + 0.8 * (float(told[1]) - least) / (full - least))
            assert flag.weight == pytest.approx(expected, abs=rounding), flag
            assert float(told[1]) >= least - rounding * (full - least)
            seen.add(flag.kind)
    assert seen == set(AMOUNTS)


def test_full_amounts_lie_beyond_their_thresholds() -> None:
    assert all(full > (least or 0.0) for _, least, full in AMOUNTS.values())
    assert TUNING.full_unblinking_s > TUNING.unblinking_s and TUNING.full_miss_mm > TUNING.missed_mm
    assert TUNING.full_swapped > TUNING.swapped and TUNING.full_out_of_step_s > TUNING.out_of_step_s
    assert TUNING.full_short_s > TUNING.short_s and TUNING.least_weight < 0 and TUNING.most_weight > 1


def test_a_face_without_a_fault_has_no_flag() -> None:
    assert not flags_of(looked(still()))
    assert not flags_of(looked(np.roll(still(), 40, axis=0)))
