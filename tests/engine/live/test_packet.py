from __future__ import annotations

import numpy as np
import pytest

from engine.live.packet import Drop, Packet, packet
from engine.take import SHAPES

FACE = np.linspace(0, 1, len(SHAPES)).astype(np.float32)
STILL = np.zeros(9, np.float32)


def spoilt(values: np.ndarray, at: int, value: float) -> np.ndarray:
    return np.where(np.arange(len(values)) == at, np.float32(value), values)


def test_finite_numbers_are_a_packet_with_or_without_a_face_and_a_clock() -> None:
    for weights in (FACE, None):
        for time_s in (1.5, None):
            found = packet("Ana", time_s, 60.0, weights, STILL)
            assert isinstance(found, Packet) and found.weights is weights and found.rotations is STILL
            assert (found.subject, found.time_s, found.fps) == ("Ana", time_s, 60.0)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_one_number_that_is_not_finite_drops_the_packet(value: float) -> None:
    for at in (0, len(SHAPES) - 1):
        assert packet("Ana", 1.0, 60.0, spoilt(FACE, at, value), STILL) is Drop.NUMBERS
    for weights in (FACE, None):
        assert packet("Ana", 1.0, 60.0, weights, spoilt(STILL, 8, value)) is Drop.NUMBERS
        assert packet("Ana", value, 60.0, weights, STILL) is Drop.NUMBERS


def test_another_number_of_shapes_is_no_face() -> None:
    for weights in (FACE[:-1], np.append(FACE, np.float32(0)), FACE[:0]):
        assert packet("Ana", None, 60.0, weights, STILL) is Drop.NUMBERS
