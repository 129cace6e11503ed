from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.clean.infer import Cleaner
from engine.clean.network import CleanConfig, CleanNetwork
from engine.errors import EditError
from engine.live.livelink import Stamp, encode
from engine.live.record import Recorder
from engine.live.replay import Network, packets, schedule
from engine.live.stream import MAX_SUBJECTS, Arrival, LiveFrame, Stream
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


def test_nothing_recorded_is_said() -> None:
    with pytest.raises(EditError, match="Nothing was recorded"):
        Recorder().take()


def test_a_recorder_keeps_no_more_than_it_may(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("engine.live.record.MAX_FRAMES", 5)
    recorder = Recorder()
    for index in range(9):
        recorder.add(Arrival(index / 60, 60.0, WEIGHTS[0], np.zeros(9, np.float32), late=False))
    assert len(recorder) == 5 and recorder.full and len(recorder.take()) == 5


def test_the_way_treats_the_same_take_alike_and_loses_its_share() -> None:
    network = Network(loss=0.2, reorder=0.1, jitter_s=0.01, seed=3)
    order = schedule(TAKE, network)
    assert order == schedule(TAKE, network) and 0.7 < len(order) / len(TAKE) < 0.9
    assert [due for due, _ in order] == sorted(due for due, _ in order)
    assert [index for _, index in order] != sorted(index for _, index in order)
    assert schedule(TAKE, Network()) == [(index / 60.0, index) for index in range(len(TAKE))]


def test_a_clock_that_leaps_with_each_packet_declares_no_more_than_time_that_passed() -> None:
    rig, tick, arrivals = Rig(), 0, 800
    for number in range(arrivals):  # 2 s of packets, each a thousandth or nine seconds after the one before
        tick += 9_000 if number % 2 else 1
        rig.send(face(tick, numerator=1000, denominator=1), arrived_s=number / 400)
    taken = rig.recorder.take()
    assert len(taken) <= 1000 * (2 + 10) + arrivals  # unbounded it would be 3.6 million frames of a kilobyte each
    assert len(rig.recorder) == arrivals and int((~taken.lost).sum()) >= arrivals / 2


def test_slow_rates_among_fast_ones_cannot_fill_the_memory() -> None:
    recorder = Recorder()
    times_s = np.cumsum(np.where(np.arange(3000) % 3, 0.001, 9.0))
    for time_s in times_s:
        recorder.add(Arrival(float(time_s), 1000.0, WEIGHTS[0], np.zeros(9, np.float32), False))
    taken = recorder.take()
    assert len(taken) < 200_000 and "shortened" in taken.notices[0]
    assert int((~taken.lost).sum()) == 3000  # no face is dropped for it


def test_a_recording_with_ordinary_pauses_keeps_them() -> None:
    recorder = Recorder()
    times_s = np.concatenate([np.arange(100) / 60, 9.0 + np.arange(100) / 60])
    for time_s in times_s:
        recorder.add(Arrival(float(time_s), 60.0, WEIGHTS[0], np.zeros(9, np.float32), False))
    assert len(recorder.take()) == round((9.0 + 99 / 60) * 60) + 1 and not recorder.take().notices


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
