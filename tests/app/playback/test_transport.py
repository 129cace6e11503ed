"""J, K and L, and their slower sisters."""

from __future__ import annotations

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.playback.clock import WallClock
from app.playback.transport import SPEEDS, Transport
from app.session import Session
from engine.take import SHAPES, Take


class Hand:
    """A clock's seconds, moved by hand."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def transport(qtbot: QtBot) -> Transport:
    session = Session(Take(np.zeros((300, len(SHAPES))), 30.0))
    made = Transport(session, WallClock(Hand()))
    made.session_ = session
    yield made
    made.run(0.0)


def test_faster_goes_up_and_slower_goes_down_from_where_it_is(transport: Transport) -> None:
    transport.faster(1)
    assert transport.speed == 1.0
    speeds = []
    for _ in range(4):
        transport.slower(1)
        speeds.append(transport.speed)
    assert speeds == [0.5, 0.25, 0.25, 0.25]
    for _ in range(6):
        transport.faster(1)
    assert transport.speed == max(SPEEDS)


@pytest.mark.parametrize("direction", [1, -1])
def test_slower_begins_at_half_in_either_direction_and_faster_turns_round_at_full(
    transport: Transport, direction: int
) -> None:
    transport.slower(direction)
    assert transport.speed == 0.5 * direction
    transport.faster(-direction)
    assert transport.speed == -1.0 * direction


@pytest.mark.parametrize("speed", [0.25, 0.5])
def test_at_a_part_of_the_speed_as_many_frames_go_by(transport: Transport, speed: float) -> None:
    clock = transport.clock._time_s
    transport.run(speed)
    clock.now = 4.0
    transport.tick()
    assert transport.session_.view.playhead == round(4.0 * speed * 30)
