from __future__ import annotations

import itertools
import socket
import time

import numpy as np
import pytest

from engine.errors import EngineError
from engine.live.decode import decode
from engine.live.packet import Packet
from engine.live.replay import Network, packets, replay, schedule
from engine.take import SHAPES, Take

RNG = np.random.default_rng(0)
WEIGHTS = RNG.random((300, len(SHAPES))).astype(np.float32)
TAKE = Take(WEIGHTS.astype(np.float64), 60.0, rotations=RNG.uniform(-0.5, 0.5, (300, 9)))


def test_the_way_treats_the_same_take_alike_and_loses_its_share() -> None:
    network = Network(loss=0.2, reorder=0.1, jitter_s=0.01, seed=3)
    order = schedule(TAKE, network)
    assert order == schedule(TAKE, network) and 0.7 < len(order) / len(TAKE) < 0.9
    assert [due for due, _ in order] == sorted(due for due, _ in order)
    assert [index for _, index in order] != sorted(index for _, index in order)
    assert schedule(TAKE, Network()) == [(index / 60.0, index) for index in range(len(TAKE))]


def test_an_address_that_is_none_is_said() -> None:
    with pytest.raises(EngineError, match="no address"):
        replay(TAKE, ("256.1.1.1", 11111))


def test_each_packet_of_a_take_says_its_frame_its_rate_and_its_face() -> None:
    lost = np.isin(np.arange(300), [3, 4])
    for fps in (24.0, 30_000 / 1001, 60.0):
        take = Take(WEIGHTS, fps, lost, TAKE.rotations)
        for index, data in enumerate(itertools.islice(packets(take, subject="Ana", first=1000), 8)):
            found = decode(data)
            assert isinstance(found, Packet) and found.subject == "Ana" and found.fps == pytest.approx(fps, rel=1e-12)
            assert found.time_s == pytest.approx((1000 + index) / fps)
            assert (found.weights is None) == lost[index]
            if found.weights is not None:
                np.testing.assert_array_equal(found.weights, WEIGHTS[index])
                np.testing.assert_array_equal(found.rotations, TAKE.rotations[index].astype(np.float32))


def test_jitter_delays_by_no_more_than_it_says_and_disorder_lets_one_frame_pass() -> None:
    late = np.array([due - index / 60 for due, index in schedule(TAKE, Network(jitter_s=0.01))])
    assert late.min() >= 0 and 0.009 < late.max() <= 0.01
    passed = schedule(TAKE, Network(reorder=0.3))
    delays = {round((due - index / 60) * 60, 6) for due, index in passed}
    assert delays == {0.0, 1.5} and 0.2 < np.mean([due > index / 60 + 1e-9 for due, index in passed]) < 0.4
    assert schedule(TAKE, Network(loss=0.2)) != schedule(TAKE, Network(loss=0.2, seed=1))


def test_a_take_is_sent_in_its_own_time_again_and_again_until_it_is_stopped() -> None:
    take, heard = Take(WEIGHTS[:5], 250.0), []
    with socket.socket(type=socket.SOCK_DGRAM) as listening:
        listening.bind(("127.0.0.1", 0))
        listening.settimeout(5)
        began = time.perf_counter()
        assert replay(take, listening.getsockname(), subject="Ana") == 5
        assert time.perf_counter() - began >= 4 / 250
        asked = itertools.count()
        assert replay(take, listening.getsockname(), repeat=True, stop=lambda: next(asked) >= 14) == 12
        for _ in range(17):
            found = decode(listening.recv(65536))
            assert isinstance(found, Packet)
            heard.append(round(found.time_s * 250))
    assert heard == [*range(5), *range(12)]
