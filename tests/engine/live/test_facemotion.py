from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.live.decode import decode
from engine.live.packet import Drop, Packet
from engine.take import SHAPE_INDEX, SHAPES

TEXT = b"mouthSmile_R-40|eyeBlink_L&3|jawOpen-100|=head#10,20,30,0,0,0|rightEye#1,2,3|leftEye#4,5,6|"


@given(st.text("mouthSmile_RL-&|=#0123456789.,einf", max_size=200))
@settings(max_examples=60)
def test_any_text_gives_a_frame_or_a_drop(text: str) -> None:
    assert isinstance(decode(b"m" + text.encode()), Packet | Drop)


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


def test_weights_are_per_cent_and_every_form_of_an_entry_is_known() -> None:
    found = decode(b"jawOpen-5|mouthLeft&100|eyeBlink_R-  |tongueOut--3|mouthClose-250|browInnerUp-7\n")
    assert isinstance(found, Packet) and found.weights is not None
    seen = {name: float(found.weights[place]) for name, place in SHAPE_INDEX.items() if found.weights[place]}
    assert seen == pytest.approx(
        {"jawOpen": 0.05, "mouthLeft": 1.0, "tongueOut": -0.03, "mouthClose": 2.5, "browInnerUp": 0.07}
    )
    assert (found.subject, found.fps, found.time_s) == ("iFacialMocap", 60.0, None) and not found.rotations.any()


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        (b"jawOpen-5|=head#3600,0,-3600,9", True),
        (b"jawOpen-5|=head#3601,0,0", False),
        (b"jawOpen-5|=head#0,0,-3601", False),
        (b"jawOpen-5|=head#1,2", False),
        (b"jawOpen-5|=head#1,2,nan", False),
        (b"jawOpen-5|=head#1,2,x", False),
        (b"jawOpen-5|=tail#x,y", True),
        (b"unheardOf-5", False),
        (b"jawOpen-5\xff", False),
    ],
)
def test_turns_are_believed_up_to_ten_times_round_and_other_parts_passed_over(text: bytes, kept: bool) -> None:
    found = decode(text)
    assert isinstance(found, Packet) if kept else found is Drop.TEXT


def test_a_text_may_be_so_long_and_no_longer() -> None:
    filler = b"jawOpen-5|" + b"x" * (8192 - 10)
    assert isinstance(decode(filler), Packet) and decode(filler + b"x") is Drop.LENGTH


def test_head_and_eyes_have_their_places_in_radians() -> None:
    found = decode(b"jawOpen-5|=head#10,20,30|leftEye#40,50,60|rightEye#70,80,90")
    assert isinstance(found, Packet)
    np.testing.assert_allclose(found.rotations, np.radians([20, 10, 30, 50, 40, 60, 80, 70, 90]), rtol=1e-6)
