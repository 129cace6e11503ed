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
from engine.take import SHAPE_INDEX, SHAPES

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


@given(st.text("mouthSmile_RL-&|=#0123456789.,einf", max_size=200))
@settings(max_examples=60)
def test_any_text_gives_a_frame_or_a_drop(text: str) -> None:
    assert isinstance(decode(b"m" + text.encode()), Packet | Drop)


@given(
    st.text(max_size=60),
    st.text(max_size=60),
    st.integers(-(2**31), 2**31 - 1),
    st.lists(st.floats(-2, 2, width=32), min_size=61, max_size=61),
)
@settings(max_examples=60)
def test_what_is_encoded_is_decoded(device: str, subject: str, frame: int, values: list[float]) -> None:
    numbers = np.array(values, np.float32)
    made = decode(encode(Stamp(frame), numbers[:52], numbers[52:], subject=subject, device=device))
    assert isinstance(made, Packet) and made.weights is not None
    assert made.subject == subject and made.time_s == frame / 60
    np.testing.assert_array_equal(made.weights, numbers[:52])
    np.testing.assert_array_equal(made.rotations, numbers[52:])


def test_bytes_lie_where_the_format_says() -> None:
    packed = b"\x06" + struct.pack(">i", 36) + b"d" * 36 + struct.pack(">i", 3) + b"Bob"
    packed += (
        struct.pack(">ifii", 120, 0.5, 60, 1) + b"\x3d" + struct.pack(">61f", *(index / 100 for index in range(61)))
    )
    made = decode(packed)
    assert isinstance(made, Packet) and made.weights is not None
    assert (made.subject, made.time_s, made.fps) == ("Bob", 120.5 / 60, 60.0)
    for name, place in (("jawLeft", 15), ("jawRight", 16), ("mouthLeft", 21), ("mouthRight", 22), ("tongueOut", 51)):
        assert made.weights[SHAPE_INDEX[name]] == np.float32(place / 100)
    np.testing.assert_allclose(made.rotations, np.arange(52, 61) / 100, rtol=1e-6)


@pytest.mark.parametrize("empty", [b"", b"\x00"])
def test_a_packet_without_shapes_says_that_no_face_is_seen(empty: bytes) -> None:
    made = decode(encode(Stamp(3), None, subject="Ana") + empty)
    assert isinstance(made, Packet) and made.weights is None


@pytest.mark.parametrize("rate", [(60, 0), (0, 1), (-60, 1), (2**31 - 1, 1)])
def test_a_rate_that_cannot_be_is_taken_as_sixty(rate: tuple[int, int]) -> None:
    made = decode(encode(Stamp(60, 0.0, *rate), WEIGHTS, subject="Ana"))
    assert isinstance(made, Packet) and (made.fps, made.time_s) == (60.0, 1.0)


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


def test_text_of_facial_mocap_apps() -> None:
    made = decode(TEXT)
    assert isinstance(made, Packet) and made.weights is not None and made.time_s is None
    assert made.weights[SHAPE_INDEX["mouthSmileRight"]] == np.float32(0.4)
    assert made.weights[SHAPE_INDEX["eyeBlinkLeft"]] == np.float32(0.03)
    np.testing.assert_allclose(np.degrees(made.rotations), [20, 10, 30, 5, 4, 6, 2, 1, 3], rtol=1e-5)


SIDED = [name.replace("Left", "_L").replace("Right", "_R") for name in SHAPES]
WHOLE_TEXT = ("|".join(f"{name}-{index}" for index, name in enumerate(SIDED)) + "|=head#1,2,3,4,5,6|\n").encode()


def test_every_shape_of_the_text_is_read() -> None:
    made = decode(WHOLE_TEXT)
    assert isinstance(made, Packet) and made.weights is not None
    np.testing.assert_allclose(made.weights, np.arange(len(SHAPES)) / 100, rtol=1e-6)
    plain = decode(b"|".join(f"{name}-{index}".encode() for index, name in enumerate(SHAPES)))
    assert isinstance(plain, Packet)
    np.testing.assert_array_equal(plain.weights, made.weights)
