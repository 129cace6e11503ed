from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.live import livelink
from engine.live.decode import decode
from engine.live.livelink import Stamp, encode
from engine.live.packet import Drop, Packet
from engine.take import SHAPES

WEIGHTS = np.linspace(0, 1, len(SHAPES)).astype(np.float32)
ROTATIONS = np.linspace(-0.5, 0.5, 9).astype(np.float32)
GOOD = encode(Stamp(7, 0.25, 60, 1), WEIGHTS, ROTATIONS, subject="Ana")
TEXT = b"mouthSmile_R-40|eyeBlink_L&3|jawOpen-100|=head#10,20,30,0,0,0|rightEye#1,2,3|leftEye#4,5,6|"


@given(st.binary(max_size=900))
@settings(max_examples=150)
def test_any_bytes_give_a_frame_or_a_drop(data: bytes) -> None:
    assert isinstance(decode(data), Packet | Drop)


@given(st.integers(0, len(GOOD) - 1), st.binary(min_size=0, max_size=8), st.integers(0, 8))
@settings(max_examples=150)
def test_any_damage_gives_a_finite_frame_or_a_drop(at: int, patch: bytes, cut: int) -> None:
    for whole in (GOOD, TEXT):
        made = decode(whole[: at % len(whole)] + patch + whole[at % len(whole) + cut :])
        assert isinstance(made, Packet | Drop)
        if isinstance(made, Packet):
            assert made.time_s is None or np.isfinite(made.time_s)
            assert made.weights is None or np.isfinite(made.weights).all()


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"", Drop.VERSION),
        (b"\x05" + GOOD[1:], Drop.VERSION),
        (GOOD[:-1], Drop.LENGTH),
        (GOOD + b"\x00", Drop.LENGTH),
        (b"\x06" + struct.pack(">i", 257) + GOOD[5:], Drop.LENGTH),
        (b"\x06" + struct.pack(">i", -1) + GOOD[5:], Drop.LENGTH),
        (GOOD[: -livelink.COUNT * 4 - 1] + b"\x3e" + GOOD[-livelink.COUNT * 4 :], Drop.COUNT),
        (GOOD[:-4] + struct.pack(">f", float("nan")), Drop.NUMBERS),
        (GOOD[:-4] + struct.pack(">f", float("inf")), Drop.NUMBERS),
        (b"nothing here", Drop.TEXT),
        (b"jawOpen-10|=head#1,2", Drop.TEXT),
        (b"jawOpen-10|=head#1,2,1e999", Drop.TEXT),
    ],
)
def test_what_is_wrong_is_named(data: bytes, why: Drop) -> None:
    assert decode(data) is why
