"""The stand-in for a loudspeaker that the bench counts dropouts with."""

from __future__ import annotations

import time

import numpy as np

from app.bench.playback import BLOCK, NullSink
from app.playback.device import LATENCY_S


def test_a_block_that_comes_after_it_should_be_heard_is_an_underrun() -> None:
    asked: list[float] = []

    def pull(frames: int, heard_from: float) -> np.ndarray | None:
        asked.append(heard_from)
        assert frames == BLOCK
        if len(asked) == 4:
            time.sleep(2 * LATENCY_S)
        return np.zeros((frames, 2), np.float32) if len(asked) < 40 else None

    sink = NullSink(8_000, 2)
    began = time.perf_counter()
    assert sink.start(pull) and sink._thread is not None
    sink._thread.join(10.0)
    spent = time.perf_counter() - began
    assert np.allclose(np.diff(asked), BLOCK / 8_000)  # it never waits for the program: a late block is a gap
    assert spent > 38 * BLOCK / 8_000 and sink.blocks == 39
    assert 1 <= sink.underruns < 39 and sink.worst_s > 2 * LATENCY_S
    assert sink.start(pull)  # and it plays again after a rest
    sink.close()
