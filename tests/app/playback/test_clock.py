"""Sound and picture in simulated time: the sound goes on without a gap, the picture follows as well as it can."""

from __future__ import annotations

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.playback.clock import REST_S, STALL_S, AudioClock, WallClock
from app.playback.source import GRAIN_S, RAMP_S, Source
from app.playback.transport import Transport
from app.session import Session
from engine.formats.audio import Audio
from engine.take import SHAPES, Take
from tests.app.playback.sinks import SimulatedSink

RATE, FPS, SECONDS = 48_000, 30.0, 8
RAMP = round(RAMP_S * RATE)


@pytest.fixture
def sound() -> Audio:
    samples = np.random.default_rng(0).uniform(-1, 1, (RATE * SECONDS, 2)).astype(np.float32)
    return Audio(samples, RATE)


@pytest.fixture
def sink() -> SimulatedSink:
    return SimulatedSink(RATE)


@pytest.fixture
def clock(sound: Audio, sink: SimulatedSink) -> AudioClock:
    return AudioClock(sound, 0.0, sink, sink.time_s)


@pytest.fixture
def session(qtbot: QtBot) -> Session:
    return Session(Take(weights=np.zeros((int(FPS * SECONDS), len(SHAPES))), fps=FPS))


@pytest.fixture
def transport(session: Session, clock: AudioClock):
    made = Transport(session, clock)
    yield made
    made.run(0.0)


def test_the_sound_goes_on_sample_by_sample_while_the_picture_drops_frames(sink, sound, session, transport) -> None:
    seen: list[int] = []
    session.changed.connect(lambda _: seen.append(session.view.playhead))
    transport.toggle()
    rng = np.random.default_rng(1)
    for pause_s in rng.uniform(0.005, 0.35, 25):  # a picture that takes up to a third of a second
        sink.run(pause_s)
        transport.tick()
        heard_s = sink.now - 100.0 - sink.latency_s
        assert session.view.playhead == max(0, int(heard_s * FPS + 0.01))
    assert max(np.diff(seen)) > 3  # dropped
    played = sink.sound()
    np.testing.assert_array_equal(played[RAMP:], sound.samples[RAMP : len(played)])


def test_the_first_samples_fade_in(sink, sound, clock) -> None:
    clock.play(1.0, 1.0, None)
    sink.run(0.1)
    way = np.minimum(np.arange(1, RAMP + 1) / RAMP, 1.0)[:, None]
    np.testing.assert_allclose(sink.sound()[:RAMP], sound.samples[RATE : RATE + RAMP] * way, atol=1e-5)


def test_a_picture_waits_for_a_device_that_has_played_nothing_yet(sink, clock) -> None:
    clock.play(2.0, 1.0, None)
    sink.run(sink.latency_s * 0.9)
    assert clock.now_s() == 2.0
    sink.run(sink.latency_s * 0.2)
    assert clock.now_s() == pytest.approx(2.0 + 0.1 * sink.latency_s)


def test_a_gap_in_the_device_holds_the_picture(sink, clock) -> None:
    clock.play(0.0, 1.0, None)
    sink.run(1.0)
    sink.now += 0.4  # asked for nothing
    assert clock.now_s() == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("speed", [1.0, 2.0, 4.0, -1.0, -2.0])
def test_speeds_move_sound_and_time_alike(sink, sound, clock, speed) -> None:
    clock.play(4.0, speed, None)
    sink.run(0.6)
    assert clock.now_s() == pytest.approx(4.0 + speed * 0.5, abs=1e-6)
    played = sink.sound()[RAMP:]
    places = 4 * RATE + (np.arange(len(played)) + RAMP) * int(speed)
    np.testing.assert_array_equal(played, sound.samples[places])


def test_j_k_l(sink, session, transport) -> None:
    session.view.move_playhead(120)
    transport.faster(1)
    transport.faster(1)
    assert transport.speed == 2.0
    sink.run(0.6)
    transport.tick()
    assert session.view.playhead == 150
    transport.faster(-1)
    sink.run(0.61)  # a running device takes the new sound with its next block
    transport.tick()
    assert (transport.speed, session.view.playhead) == (-1.0, 135)
    transport.run(0.0)
    sink.run(0.5)
    assert session.view.playhead == 135 and not transport.playing


def test_a_loop_wraps_on_the_sample(sink, sound, session, transport) -> None:
    session.view.select((30, 45))
    transport.set_loop(True)
    transport.toggle()
    assert session.view.playhead == 30
    for _ in range(120):
        sink.run(0.016)
        transport.tick()
        assert 30 <= session.view.playhead < 45
    places = RATE + np.arange(len(sink.sound())) % (RATE // 2)
    np.testing.assert_array_equal(sink.sound()[RAMP:], sound.samples[places[RAMP:]])


@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_playing_ends_at_the_end_of_the_range(sink, session, transport, speed) -> None:
    session.view.select((30, 45))
    transport.run(speed)
    sink.run(2.0)
    transport.tick()
    assert session.view.playhead == (44 if speed > 0 else 30) and not transport.playing
    sink.played.clear()
    sink.run(0.1)
    assert not sink.sound()[2 * RAMP :].any()


def test_a_seek_while_playing_goes_on_from_there(sink, sound, session, transport) -> None:
    transport.toggle()
    sink.run(0.5)
    transport.tick()
    session.view.move_playhead(180)
    sink.played.clear()
    sink.run(0.51)
    transport.tick()
    assert session.view.playhead == 192
    np.testing.assert_array_equal(sink.sound()[RAMP:], sound.samples[6 * RATE + RAMP : 6 * RATE + len(sink.sound())])


def test_scrubbing_lets_a_short_grain_be_heard_and_then_rests(sink, sound, session, transport) -> None:
    session.view.move_playhead(60)
    sink.run(REST_S + 1.0)
    played = np.abs(sink.sound()).max(axis=1)
    heard = np.flatnonzero(played)
    assert heard[0] <= 2 and heard[-1] <= GRAIN_S * RATE and len(heard) > 0.9 * GRAIN_S * RATE
    middle = round(GRAIN_S / 2 * RATE)
    np.testing.assert_allclose(sink.sound()[middle], sound.samples[2 * RATE], atol=1e-3)
    assert not sink.pulling and not transport.playing


def test_a_quick_scrub_is_of_even_loudness(sink) -> None:
    clock = AudioClock(Audio(np.full(RATE * 4, 0.5, np.float32), RATE), 0.0, sink, sink.time_s)
    for step in range(100):
        clock.scrub(1.0 + 0.01 * step)
        sink.run(0.01)
    steady = sink.sound()[round(GRAIN_S / 2 * RATE) : round(0.9 * RATE), 0]
    assert steady.min() > 0.499 and steady.max() <= 0.5 + 1e-6


def test_a_loudspeaker_that_vanishes_leaves_the_time_to_the_wall(sink, clock) -> None:
    clock.play(0.0, 1.0, None)
    sink.run(1.0)
    sink.present = False
    sink.run(STALL_S + 0.2)
    held = clock.now_s()
    assert held == pytest.approx(1.0, abs=0.01)
    sink.run(1.0)
    assert clock.now_s() == pytest.approx(held + 1.0)
    clock.play(3.0, 2.0, None)  # and one that cannot be started at all
    sink.run(0.25)
    assert clock.now_s() == pytest.approx(3.5)


def test_muted_is_silent_and_time_runs_on(sink, clock) -> None:
    clock.muted = True
    clock.play(0.0, 1.0, None)
    sink.run(0.6)
    assert not sink.sound().any() and clock.now_s() == pytest.approx(0.5)


def test_sound_that_begins_later_and_ends_earlier_than_the_take(sink, sound) -> None:
    clock = AudioClock(Audio(sound.samples[:RATE], RATE), 0.5, sink, sink.time_s)
    clock.play(0.0, 1.0, None)
    sink.run(2.1)
    assert clock.now_s() == pytest.approx(2.0)
    played = sink.sound()
    assert not played[: RATE // 2].any() and not played[3 * RATE // 2 :].any()
    np.testing.assert_array_equal(played[RATE // 2 : 3 * RATE // 2], sound.samples[:RATE])


def test_a_device_of_another_rate_hears_the_same_tone() -> None:
    tone = np.sin(2 * np.pi * 440 * np.arange(RATE) / RATE).astype(np.float32)
    source = Source(Audio(tone, RATE), offset_s=0.0, out_rate=44_100)
    source.play(0.0, 1.0, None)
    played = np.concatenate([source.pull(441, 0.0) for _ in range(50)])[:, 0]
    wanted = np.sin(2 * np.pi * 440 * np.arange(len(played)) / 44_100)
    np.testing.assert_allclose(played[400:], wanted[400:], atol=1e-3)


def test_the_wall_clock_runs_loops_and_stands() -> None:
    now = [5.0]
    clock = WallClock(lambda: now[0])
    clock.play(1.0, 2.0, None)
    now[0] += 0.5
    assert clock.now_s() == 2.0
    clock.stop()
    now[0] += 9.0
    assert clock.now_s() == 2.0
    clock.play(1.0, -1.0, (0.5, 1.5))
    now[0] += 0.75
    assert clock.now_s() == 1.25
