from __future__ import annotations

import numpy as np

from engine.lab.performer.performer import Script, perform, phones
from engine.speech.bilabials import closures
from engine.speech.transcript import Transcript
from engine.speech.visemes import Cue

SCRIPT = Script(phones=("SIL", *["AA1", "B", "AE1", "EH1", "M", "AA1", "T", "AE1"] * 5, "SIL"), seed=1)


def test_lips_meet_where_a_performance_says_so_and_not_elsewhere() -> None:
    take = perform(SCRIPT)
    cues = tuple(Cue(start, stop, symbol) for start, stop, symbol in phones(SCRIPT))
    met = closures(Transcript((), cues, take.duration_s), take)
    assert met.said == 10 and met.closed == 10 and met.by_chance < 8
    late = tuple(Cue(cue.start_s + 0.18, cue.stop_s + 0.18, cue.label) for cue in cues)
    assert closures(Transcript((), late, take.duration_s), take).closed < 10


def test_nothing_is_said_where_there_is_nothing_of_the_take() -> None:
    take = perform(SCRIPT)
    met = closures(Transcript((), (Cue(0, 0.1, "M"),), 0.1), take, offset_s=take.duration_s + 1)
    assert met.said == 0 == met.closed and np.isfinite(met.by_chance)
