from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest

from engine.clean.infer import Cleaner
from engine.clean.network import CleanConfig, CleanNetwork
from engine.errors import EngineError
from engine.live.listen import PER_S, QUEUE, SENDERS, Allowances, Listener
from engine.live.livelink import Stamp, encode
from engine.live.record import Recorder
from engine.live.replay import Network, replay, schedule
from engine.live.stream import Stream
from engine.take import SHAPES, Take

CLEANER = Cleaner(CleanNetwork(CleanConfig(hidden=8)))
WEIGHTS = np.random.default_rng(0).random((120, len(SHAPES))).astype(np.float32)
TAKE = Take(WEIGHTS.astype(np.float64), 120.0)


def wait_for(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 5
    while not condition():
        assert time.monotonic() < deadline, "timed out"
        time.sleep(0.005)


def test_a_replayed_take_is_received_cleaned_and_recorded() -> None:
    recorder = Recorder()
    network = Network(loss=0.05, reorder=0.05, jitter_s=0.005)
    arriving = sorted(index for _, index in schedule(TAKE, network))
    with Listener(Stream(cleaner=CLEANER, on_arrival=recorder.add), port=0) as listener:
        assert replay(TAKE, listener.address, network) == len(arriving)
        wait_for(lambda: len(recorder) == len(arriving))
        frames, status = listener.frames(), listener.status()
    taken = recorder.take()
    np.testing.assert_array_equal(taken.weights[~taken.lost], WEIGHTS[arriving])
    assert len(frames) == status.frames == len(arriving) - status.drops["late or doubled"]
    assert status.latency_p95_ms < 50 and not listener.frames()


def test_only_loopback_hears_unless_asked() -> None:
    with Listener(Stream(cleaner=CLEANER), port=0) as listener:
        assert listener.address[0] == "127.0.0.1"


def test_a_flood_is_counted_and_does_not_grow() -> None:
    data = encode(Stamp(1), WEIGHTS[0], subject="Ana")
    with Listener(Stream(cleaner=CLEANER), port=0) as listener, socket.socket(type=socket.SOCK_DGRAM) as out:
        for _ in range(3000):
            out.sendto(data, listener.address)
        wait_for(lambda: listener.status().drops.get("too many", 0) > 0)
        assert listener.status().frames == 1
    assert not [thread for thread in threading.enumerate() if thread.name == "retake-live"]


def test_each_sender_has_its_own_allowance() -> None:
    allowances = Allowances()
    assert sum(allowances.take("flood", 1.0) for _ in range(5000)) == QUEUE
    assert allowances.take("phone", 1.0)
    assert sum(allowances.take("flood", 1.0 + index / 5000) for index in range(5000)) == pytest.approx(PER_S, abs=2)
    for index in range(100):
        allowances.take(f"invented {index}", 2.0)
    assert len(allowances._left) <= SENDERS + 1


@pytest.mark.parametrize(("bind", "port"), [("256.1.1.1", 0), ("127.0.0.1", 99999), ("192.0.2.1", 0)])
def test_what_cannot_be_listened_on_is_said(bind: str, port: int) -> None:
    with pytest.raises(EngineError):
        Listener(Stream(cleaner=CLEANER), bind=bind, port=port)


def test_a_port_in_use_is_said() -> None:
    with (
        Listener(Stream(cleaner=CLEANER), port=0) as listener,
        pytest.raises(EngineError, match="cannot be listened on"),
    ):
        Listener(Stream(cleaner=CLEANER), port=listener.address[1])


def test_an_allowance_fills_again_at_its_rate_and_no_further_than_a_burst() -> None:
    allowances = Allowances(per_s=10.0, burst=3)
    assert [allowances.take("a", 0.0) for _ in range(4)] == [True, True, True, False]
    assert [allowances.take("a", at) for at in (0.05, 0.1, 0.15, 0.2)] == [False, True, False, True]
    assert [allowances.take("a", 60.0) for _ in range(4)] == [True, True, True, False]


def test_a_sender_beyond_the_last_place_shares_one_allowance_until_another_falls_silent() -> None:
    allowances = Allowances(per_s=1e-9, burst=2)
    for number in range(SENDERS):
        assert allowances.take(f"{number}", number / 1000)
    assert [allowances.take(name, 1.0) for name in ("x", "y", "z")] == [True, True, False]
    assert [allowances.take(name, 10.0) for name in ("x", "y")] == [False, False]
    assert [allowances.take("w", 10.0005) for _ in range(3)] == [True, True, False]  # "0" was silent for ten seconds
    assert allowances.take("0", 10.0005) is False


def test_a_listener_tells_the_latency_that_nineteen_of_twenty_frames_keep() -> None:
    with Listener(Stream(cleaner=CLEANER), port=0) as listener:
        assert np.isnan(listener.status().latency_p95_ms) and listener.status().subjects == ()
        listener._latencies.extend(range(101))
        assert listener.status().latency_p95_ms == 95.0
