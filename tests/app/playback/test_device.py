"""The loudspeaker's side of PortAudio, with its Python module played by a stand-in."""

from __future__ import annotations

import sys
from types import ModuleType, SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest

from app.playback import device

DEVICES = [
    {"name": name, "index": index, "default_samplerate": 44_100.0, "max_output_channels": channels}
    for index, (name, channels) in enumerate([("Microphone", 0), ("Built-in", 2), ("Headset", 2)])
]


class Stream:
    made: ClassVar[list[Stream]] = []
    gone: ClassVar[bool] = False

    def __init__(self, *, samplerate, channels, dtype, latency, callback, device) -> None:
        if samplerate != 44_100:
            raise module().PortAudioError("Invalid sample rate")
        self.latency, self.active, self.starts, self.callback = latency, False, 0, callback
        self.channels, self.closed, self.device = channels, False, device
        Stream.made.append(self)

    def start(self) -> None:
        if Stream.gone:
            raise module().PortAudioError("Device unavailable")
        self.active, self.starts = True, self.starts + 1

    def abort(self) -> None:
        self.active = False

    def close(self) -> None:
        self.closed = True

    def ask(self, frames: int, *, dac: float = 10.05, now: float = 10.0) -> np.ndarray:
        """As PortAudio does: call back, and stop where the callback says so."""
        out = np.full((frames, self.channels), 9.0, np.float32)
        try:
            self.callback(out, frames, SimpleNamespace(outputBufferDacTime=dac, currentTime=now), None)
        except module().CallbackStop:
            self.active = False
        return out


def module() -> ModuleType:
    return sys.modules["sounddevice"]


@pytest.fixture
def portaudio(monkeypatch):
    stand_in = ModuleType("sounddevice")
    stand_in.PortAudioError = type("PortAudioError", (Exception,), {})
    stand_in.CallbackStop = type("CallbackStop", (Exception,), {})
    stand_in.OutputStream = Stream
    stand_in.query_devices = lambda kind=None: DEVICES[1] if kind else DEVICES
    monkeypatch.setitem(sys.modules, "sounddevice", stand_in)
    monkeypatch.setattr(Stream, "gone", False)
    monkeypatch.setattr(device.time, "perf_counter", lambda: 500.0)
    return stand_in


def test_a_device_that_refuses_the_rate_is_asked_at_its_own(portaudio) -> None:
    assert device.open_device(48_000, 2).rate == 44_100


@pytest.mark.parametrize(("wanted", "found"), [("", 1), ("Headset", 2), ("Microphone", 1), ("unplugged", 1)])
def test_a_device_is_chosen_by_name_and_where_it_is_gone_the_system_s_own_plays(portaudio, wanted, found) -> None:
    assert device.names() == ["Built-in", "Headset"]
    sink = device.open_device(44_100, 2, wanted=wanted)
    assert (sink.name, Stream.made[-1].device) == (DEVICES[found]["name"], found)


@pytest.mark.parametrize("error", [ValueError("no default"), OSError("no PortAudio"), LookupError("odd")])
def test_no_device_is_none(portaudio, monkeypatch, error) -> None:
    def refuse(kind: str = "") -> None:
        raise error

    monkeypatch.setattr(portaudio, "query_devices", refuse)
    assert device.open_device(48_000, 2) is None and device.names() == []
    monkeypatch.setitem(sys.modules, "sounddevice", None)  # not installed
    assert device.open_device(48_000, 2) is None


def test_blocks_come_with_the_time_they_are_heard_and_the_device_rests_and_starts_again(portaudio) -> None:
    sink = device.open_device(44_100, 2)
    stream, heard = Stream.made[-1], []
    answers = [np.ones((64, 2), np.float32), None, np.ones((64, 2), np.float32)]

    def pull(frames: int, at: float) -> np.ndarray | None:
        heard.append(at)
        return answers.pop(0)

    assert sink.start(pull) and sink.start(pull) and stream.starts == 1
    assert (stream.ask(64) == 1.0).all()
    assert heard == [pytest.approx(500.05)]
    assert (stream.ask(64, dac=0.0) == 0.0).all()  # a driver that does not tell when: its latency counts
    assert heard[-1] == pytest.approx(500.0 + device.LATENCY_S) and not stream.active
    assert sink.start(pull) and stream.starts == 2
    assert (stream.ask(64) == 1.0).all()
    sink.close()
    assert stream.closed


def test_a_device_that_has_gone_says_so(portaudio, monkeypatch) -> None:
    sink = device.open_device(44_100, 2)
    monkeypatch.setattr(Stream, "gone", True)
    assert not sink.start(lambda frames, at: None)
