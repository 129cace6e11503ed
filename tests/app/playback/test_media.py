from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest
import soundfile
from pytestqt.qtbot import QtBot

from app.bench.playback import NullSink
from app.playback.clock import AudioClock, WallClock
from app.playback.device import open_device
from app.playback.media import Media
from app.playback.transport import Transport
from app.session import Change, Session
from engine.take import SHAPES, Take

RATE = 16_000


class Desk:
    """A session with its transport and media, and the loudspeakers that were opened."""

    def __init__(self) -> None:
        self.sinks: list[NullSink] = []
        self.session = Session(Take(weights=np.zeros((90, len(SHAPES))), fps=30.0))
        self.transport = Transport(self.session)
        self.media = Media(self.session, self.transport, self.open_sink)

    def open_sink(self, rate: int, channels: int) -> NullSink:
        self.sinks.append(NullSink(rate, channels))
        return self.sinks[-1]


@pytest.fixture
def desk(qtbot: QtBot):
    before = set(threading.enumerate())
    made = Desk()
    yield made
    made.transport.run(0.0)
    made.media.close()
    assert set(threading.enumerate()) <= before  # no thread is left


def recording(path: Path, seconds: float = 3.0) -> Path:
    soundfile.write(path, np.random.default_rng(0).uniform(-0.5, 0.5, round(seconds * RATE)), RATE)
    return path


def open_beside(qtbot: QtBot, desk: Desk, take: Path) -> None:
    with qtbot.waitSignal(desk.session.changed, check_params_cb=lambda c: bool(c & Change.MEDIA), timeout=10_000):
        desk.session.open(desk.session.document.take, take)


def test_the_sound_beside_a_take_is_played_with_it_and_leaves_with_it(qtbot, desk, tmp_path) -> None:
    path = recording(tmp_path / "a.wav")
    open_beside(qtbot, desk, tmp_path / "a.csv")
    assert desk.session.document.audio.path == path
    assert isinstance(desk.transport.clock, AudioClock)
    desk.session.open(desk.session.document.take, tmp_path / "b.csv")
    assert desk.session.document.audio is None and isinstance(desk.transport.clock, WallClock)


def test_sound_read_for_a_take_that_is_closed_is_dropped(qtbot, desk, tmp_path) -> None:
    recording(tmp_path / "a.wav")
    with qtbot.waitSignal(desk.media.reading.done, timeout=10_000):
        desk.session.open(desk.session.document.take, tmp_path / "a.csv")
        desk.session.open(desk.session.document.take, tmp_path / "b.csv")
    assert desk.session.document.audio is None and not desk.sinks


def test_sound_attached_by_hand_wins_over_what_is_found(qtbot, desk, tmp_path) -> None:
    recording(tmp_path / "a.wav")
    open_beside(qtbot, desk, tmp_path / "a.csv")
    with qtbot.waitSignal(desk.session.changed, check_params_cb=lambda c: bool(c & Change.MEDIA), timeout=10_000):
        desk.media.attach("audio", recording(tmp_path / "other.wav"))
    assert desk.session.document.audio.path.name == "other.wav"


def test_what_cannot_be_read_gives_a_sentence_and_changes_nothing(qtbot, desk, tmp_path) -> None:
    (tmp_path / "bad.wav").write_text("no sound")
    with qtbot.waitSignal(desk.media.failed, timeout=10_000) as told:
        desk.media.attach("audio", tmp_path / "bad.wav")
    assert told.args[0].startswith("bad.wav") and desk.session.document.audio is None


def test_without_a_device_the_wall_clock_is_used(qtbot, tmp_path) -> None:
    session = Session(Take(weights=np.zeros((90, len(SHAPES))), fps=30.0))
    transport = Transport(session)
    media = Media(session, transport, lambda rate, channels: None)
    with qtbot.waitSignal(session.changed, check_params_cb=lambda c: bool(c & Change.MEDIA), timeout=10_000):
        media.attach("audio", recording(tmp_path / "a.wav"))
    assert isinstance(transport.clock, WallClock)
    transport.toggle()
    qtbot.waitUntil(lambda: session.view.playhead > 3, timeout=5_000)
    transport.run(0.0)
    media.close()


def test_a_computer_without_a_loudspeaker_is_no_error(capfd) -> None:
    sink = open_device(48_000, 2)
    if sink is not None:
        sink.close()
    assert capfd.readouterr().err == ""
