from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.live.decode import decode
from engine.live.livelink import WIRE_ORDER, Stamp, encode
from engine.live.packet import Drop, Packet
from engine.take import SHAPE_INDEX, SHAPES

WEIGHTS = np.linspace(0, 1, len(SHAPES)).astype(np.float32)
ROTATIONS = np.linspace(-0.5, 0.5, 9).astype(np.float32)


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


def named(bytes_: int, face: bool = True) -> bytes:
    name = b"n" * bytes_
    head = (
        b"\x06" + struct.pack(">i", bytes_) + name + struct.pack(">i", 2) + b"Bo" + struct.pack(">ifii", 6, 0.0, 30, 1)
    )
    return head + (b"\x3d" + struct.pack(">61f", *([0.5] * 61)) if face else b"")


def test_names_are_as_long_as_they_may_be_and_no_longer() -> None:
    for length in (0, 256):
        found = decode(named(length))
        assert isinstance(found, Packet) and (found.subject, found.time_s) == ("Bo", 0.2)
    assert decode(named(257)) is Drop.LENGTH
    found = decode(encode(Stamp(1), WEIGHTS, subject="s" * 400, device="d" * 400))
    assert isinstance(found, Packet) and found.subject == "s" * 256


def test_a_packet_cut_off_anywhere_is_a_drop_or_says_that_no_face_is_seen() -> None:
    whole, bare = named(3), len(named(3, face=False))
    for length in range(1, len(whole)):
        found = decode(whole[:length])
        if length == bare:
            assert isinstance(found, Packet) and found.weights is None and found.time_s == 0.2
        else:
            assert found is Drop.LENGTH, length
    assert decode(whole[:bare] + b"\x01") is Drop.COUNT


@pytest.mark.parametrize(
    ("numerator", "denominator", "fps"),
    [(1, 1, 1.0), (1000, 1, 1000.0), (999, 1000, 60.0), (1001, 1, 60.0), (30_000, 1001, 30_000 / 1001), (5, 0, 60.0)],
)
def test_a_rate_is_believed_from_one_to_a_thousand(numerator: int, denominator: int, fps: float) -> None:
    assert Stamp(0, 0.0, numerator, denominator).fps == fps


def test_jaw_and_mouth_go_left_first_on_the_wire_and_nothing_else_changes_place() -> None:
    moved = [place for place, (wire, ours) in enumerate(zip(WIRE_ORDER, SHAPES, strict=True)) if wire != ours]
    assert [WIRE_ORDER[place] for place in moved] == ["jawLeft", "jawRight", "mouthLeft", "mouthRight"]
    assert sorted(WIRE_ORDER) == sorted(SHAPES)
