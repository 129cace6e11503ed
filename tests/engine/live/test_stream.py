from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.clean.infer import Cleaner
from engine.clean.network import CleanConfig, CleanNetwork
from engine.live.livelink import Stamp, encode
from engine.live.packet import Packet
from engine.live.record import Recorder
from engine.live.replay import Network, packets, schedule
from engine.live.stream import MAX_SUBJECTS, Clock, LiveFrame, Stream
from engine.take import SHAPES, Take

CLEANER = Cleaner(CleanNetwork(CleanConfig(hidden=8)))
RNG = np.random.default_rng(0)
WEIGHTS = RNG.random((300, len(SHAPES))).astype(np.float32)
TAKE = Take(WEIGHTS.astype(np.float64), 60.0, rotations=RNG.uniform(-0.5, 0.5, (300, 9)))


class Rig:
    """A stream with a recorder and a clock that stands."""

    def __init__(self, **settings: object) -> None:
        self.recorder = Recorder()
        self.stream = Stream(cleaner=CLEANER, on_arrival=self.recorder.add, **settings)  # type: ignore[arg-type]

    def send(self, data: bytes, arrived_s: float = 0.0) -> LiveFrame | None:
        return self.stream.receive(data, arrived_s, lambda: arrived_s + 0.001)


def face(frame: int, weights: np.ndarray | None = WEIGHTS[0], subject: str = "Ana", **rate: int) -> bytes:
    return encode(Stamp(frame, **rate), weights, subject=subject)


@given(st.lists(st.one_of(st.binary(max_size=40), st.integers(-(2**31), 2**31 - 1)), max_size=20))
@settings(max_examples=50, deadline=None)
def test_whatever_is_sent_the_stream_goes_on(sent: list[bytes | int]) -> None:
    rig = Rig()
    for item in sent:
        frame = rig.send(item if isinstance(item, bytes) else face(item))
        assert frame is None or (np.isfinite(frame.clean).all() and np.isfinite(frame.time_s))
    assert sum(rig.stream.counts.values()) == len(sent)
    assert rig.send(face(7)) is not None or rig.stream.counts["late or doubled"]


def test_frames_are_cleaned_in_order_and_late_ones_counted() -> None:
    rig = Rig()
    times = [frame.time_s for number in (10, 11, 13, 12, 13, 14) if (frame := rig.send(face(number)))]
    np.testing.assert_allclose(times, np.array([0, 1, 3, 4]) / 60)
    assert rig.stream.counts == {"frames": 4, "late or doubled": 2}


def test_strength_goes_from_raw_to_clean() -> None:
    raw, half, clean = (Rig(strength=strength) for strength in (0.0, 0.5, 1.0))
    for number in range(20):
        frames = [rig.send(face(number, WEIGHTS[number])) for rig in (raw, half, clean)]
        assert all(frames)
        np.testing.assert_array_equal(frames[0].clean, WEIGHTS[number])
        np.testing.assert_allclose(frames[1].clean, (frames[0].clean + frames[2].clean) / 2, atol=1e-6)
    assert np.abs(frames[2].clean - WEIGHTS[19]).max() > 0.001


def test_a_face_that_goes_is_bridged_and_marked() -> None:
    rig = Rig()
    assert rig.send(face(0, None)) is None and rig.stream.counts["no face yet"] == 1
    seen, gone = rig.send(face(1)), rig.send(face(2, None))
    assert seen and gone and gone.lost and not seen.lost
    np.testing.assert_array_equal(gone.raw, WEIGHTS[0])


def test_weights_that_no_face_has_are_counted_and_do_no_harm() -> None:
    rig = Rig()
    for number in range(40):
        weights = np.full(len(SHAPES), 100.0, np.float32) if number == 5 else WEIGHTS[0]
        frame = rig.send(face(number, weights))
        assert frame is not None and np.abs(frame.clean - WEIGHTS[0]).max() < 0.01
    assert rig.stream.counts["weights that no face has"] == 1


def test_only_the_chosen_face_is_followed() -> None:
    rig = Rig()
    assert rig.send(face(0, subject="Ana")) and rig.send(face(1, subject="Bob")) is None
    rig.stream.choose("Bob")
    frame = rig.send(face(2, subject="Bob"))
    assert frame is not None and frame.time_s == 1 / 60 and rig.stream.subjects == ["Ana", "Bob"]
    for index in range(100):
        rig.send(face(3, subject=f"invented {index}"))
    assert len(rig.stream.subjects) == MAX_SUBJECTS


@pytest.mark.parametrize("leap", [-100_000, 100_000])
def test_a_sender_that_starts_anew_is_followed(leap: int) -> None:
    rig = Rig()
    rig.send(face(200_000))
    frame = rig.send(face(200_000 + leap))
    assert frame is not None and frame.time_s == pytest.approx(1 / 60)


def test_a_recording_holds_what_arrived() -> None:
    rig = Rig()
    data = list(packets(TAKE, subject="Ana"))
    order = schedule(TAKE, Network(loss=0.05, reorder=0.1, jitter_s=0.03, seed=1))
    for due, index in order:
        rig.send(data[index], due)
    arrived = sorted(index for _, index in order)
    taken = rig.recorder.take()
    assert taken.fps == 60.0 and len(taken) == arrived[-1] - arrived[0] + 1
    np.testing.assert_array_equal(np.flatnonzero(~taken.lost) + arrived[0], arrived)
    np.testing.assert_array_equal(taken.weights[~taken.lost], WEIGHTS[arrived])
    np.testing.assert_array_equal(taken.rotations[~taken.lost], TAKE.rotations[arrived].astype(np.float32))
    assert rig.stream.counts["late or doubled"] > 0


def test_a_phone_that_sends_every_other_tick_gives_thirty_frames() -> None:
    rig = Rig()
    for number in range(0, 120, 2):
        rig.send(face(number))
    taken = rig.recorder.take()
    assert (taken.fps, len(taken), taken.lost.any()) == (30.0, 60, False)


def test_a_clock_that_leaps_with_each_packet_declares_no_more_than_time_that_passed() -> None:
    rig, tick, arrivals = Rig(), 0, 800
    for number in range(arrivals):  # 2 s of packets, each a thousandth or nine seconds after the one before
        tick += 9_000 if number % 2 else 1
        rig.send(face(tick, numerator=1000, denominator=1), arrived_s=number / 400)
    taken = rig.recorder.take()
    assert len(taken) <= 1000 * (2 + 10) + arrivals  # unbounded it would be 3.6 million frames of a kilobyte each
    assert len(rig.recorder) == arrivals and int((~taken.lost).sum()) >= arrivals / 2


def test_invented_names_do_not_keep_a_phone_out() -> None:
    rig = Rig()
    for index in range(MAX_SUBJECTS):
        rig.send(face(index, subject=f"squatter {index}"))
    for index in range(200):  # one packet of the phone among five with new names
        rig.send(face(index, subject="phone"), arrived_s=index / 60)
        for other in range(5):
            rig.send(face(index, subject=f"invented {index} {other}"), arrived_s=index / 60)
    assert "phone" in rig.stream.subjects and len(rig.stream.subjects) == MAX_SUBJECTS
    assert rig.stream.subject == "squatter 0"


def test_a_face_that_falls_silent_gives_way_unless_it_was_chosen_or_is_recorded() -> None:
    stream = Stream(cleaner=CLEANER)

    def send(subject: str, arrived_s: float) -> LiveFrame | None:
        return stream.receive(face(round(60 * arrived_s), subject=subject), arrived_s, lambda: arrived_s)

    assert send("squatter", 0.0) and send("phone", 5.0) is None
    frame = send("phone", 10.5)
    assert frame is not None and frame.subject == "phone" and stream.subject == "phone"
    stream.choose("Bob")
    assert send("phone", 10.6) is None and send("phone", 30.0) is None and stream.subject == "Bob"
    recorded = Rig()
    assert recorded.send(face(0, subject="Ana")) and recorded.send(face(1, subject="Bob"), 99.0) is None


def at(time_s: float | None, fps: float = 50.0) -> Packet:
    return Packet("Ana", time_s, fps, WEIGHTS[0], np.zeros(9, np.float32))


def test_a_clock_places_packets_by_the_sender_s_time_and_knows_late_ones() -> None:
    clock = Clock()
    assert clock.place(at(700.0), 3.0) == (0.0, False)
    assert clock.place(at(700.5), 3.5) == (pytest.approx(0.5), False)
    assert clock.place(at(700.25), 3.5) == (pytest.approx(0.25), True)
    assert clock.place(at(700.5), 3.6) == (pytest.approx(0.5), False)
    assert clock.place(at(698.6), 3.7) == (pytest.approx(-1.4), True)  # 1.9 s back: late, the clock is not set back
    assert clock.place(at(700.75), 4.0) == (pytest.approx(0.75), False)


@pytest.mark.parametrize("leap_s", [-2.1, 10.1, -1e5, 1e5])
def test_a_clock_that_is_set_anew_goes_on_one_frame_later(leap_s: float) -> None:
    clock = Clock()
    clock.place(at(100.0), 50.0)
    clock.place(at(101.0), 51.0)
    assert clock.place(at(101.0 + leap_s), 99.0) == (pytest.approx(1.02), False)
    assert clock.place(at(101.5 + leap_s), 99.5) == (pytest.approx(1.52), False)


def test_a_clock_follows_the_last_packet_where_it_is_told_to_begin_anew() -> None:
    clock = Clock()
    clock.place(at(100.0), 50.0)
    clock.restart()
    assert clock.place(at(5000.0), 50.5) == (pytest.approx(0.02), False)
    assert clock.place(at(5000.3), 50.8) == (pytest.approx(0.32), False)


def test_a_clock_runs_ahead_of_the_time_that_passed_by_ten_seconds_at_most() -> None:
    clock = Clock()
    assert clock.place(at(0.0), 70.0) == (0.0, False)
    assert clock.place(at(9.5), 70.0) == (pytest.approx(9.5), False)
    assert clock.place(at(11.0), 70.0) == (pytest.approx(9.52), False)
    assert clock.place(at(11.25), 70.0) == (pytest.approx(9.77), False)
    assert clock.place(at(13.0), 73.0) == (pytest.approx(11.52), False)


def test_a_sender_without_a_clock_is_placed_by_arrival() -> None:
    clock = Clock()
    assert [clock.place(at(None), 20.0 + step / 4)[0] for step in range(4)] == pytest.approx([0.0, 0.25, 0.5, 0.75])


class Noted:
    """A cleaner that notes what it is asked for, and shows the time it was led through."""

    def __init__(self) -> None:
        self.steps: list[tuple[bool, float]] = []

    def start(self, weights: np.ndarray) -> SimpleNamespace:
        return SimpleNamespace(output=weights)

    def step(self, seen: np.ndarray | None, step_s: float, state: SimpleNamespace) -> SimpleNamespace:
        self.steps.append((seen is not None, step_s))
        return state


@pytest.mark.parametrize(("missed", "bridged"), [(0, 0), (1, 0), (2, 2), (5, 5), (16, 16), (17, 16), (300, 16)])
def test_frames_that_never_came_are_bridged_up_to_a_limit(missed: int, bridged: int) -> None:
    noted = Noted()
    stream = Stream(cleaner=noted)  # type: ignore[arg-type]
    for frame in (0, missed + 1):
        assert stream.receive(face(frame), 0.0, lambda: 0.0) is not None
    assert [seen for seen, _ in noted.steps] == [False] * bridged + [True]
    assert [step for _, step in noted.steps] == pytest.approx([(missed + 1) / 60 / (bridged + 1)] * (bridged + 1))


def test_latency_is_told_in_milliseconds_and_rotations_as_sent() -> None:
    rig = Rig()
    frame = rig.send(encode(Stamp(3), WEIGHTS[0], np.arange(9, dtype=np.float32), subject="Ana"), 12.5)
    assert frame is not None and frame.latency_ms == pytest.approx(1.0) and frame.arrived_s == 12.5
    np.testing.assert_array_equal(frame.rotations, np.arange(9))
    assert (frame.fps, frame.time_s, frame.subject) == (60.0, 0.0, "Ana")


def test_a_face_gives_way_after_ten_silent_seconds_and_not_before() -> None:
    stream = Stream(cleaner=CLEANER)
    for subject, arrived_s, follows in (("Ana", 0.0, True), ("Bob", 10.0, False), ("Bob", 10.1, True)):
        found = stream.receive(face(round(60 * arrived_s), subject=subject), arrived_s, lambda: 0.0)
        assert (found is not None) == follows, arrived_s
    assert stream.counts["another subject"] == 1
    named = Stream(cleaner=CLEANER, subject="Ana")
    assert named.receive(face(1, subject="Bob"), 99.0, lambda: 0.0) is None and named.subject == "Ana"
